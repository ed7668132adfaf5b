// HALFSPACE_API marks what a shared build exports; everything else is hidden.
//
// HALFSPACE_SHARED is defined by the package for users of the shared library,
// HALFSPACE_BUILDING only while the library itself is compiled.
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
