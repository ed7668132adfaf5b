// The library's version, as numbers and as text. CMake reads it from here.
#ifndef HALFSPACE_VERSION_H_
#define HALFSPACE_VERSION_H_

#define HALFSPACE_VERSION_MAJOR 0
#define HALFSPACE_VERSION_MINOR 1
#define HALFSPACE_VERSION_PATCH 0
#define HALFSPACE_VERSION_STRING "0.1.0"

#endif  // HALFSPACE_VERSION_H_
