// HALFSPACE_API marks the symbols that a shared library exports. All other
// symbols are hidden.
//
// The installed package defines HALFSPACE_SHARED for users of a shared library.
// HALFSPACE_BUILDING is defined only while the library itself is compiled.
#ifndef HALFSPACE_EXPORT_H_
#define HALFSPACE_EXPORT_H_

#if !defined(HALFSPACE_SHARED)
#define HALFSPACE_API
#elif defined(_WIN32) && defined(HALFSPACE_BUILDING)
#define HALFSPACE_API __declspec(dllexport)
#elif defined(_WIN32)
#define HALFSPACE_API __declspec(dllimport)
#else
#define HALFSPACE_API __attribute__((visibility("default")))
#endif

#endif  // HALFSPACE_EXPORT_H_
