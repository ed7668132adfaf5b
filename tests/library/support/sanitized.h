// HALFSPACE_SANITIZED is defined where a sanitizer watches memory: it ends the
// process where memory cannot be had, and frames are larger with it.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_SANITIZED_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_SANITIZED_H_

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HALFSPACE_SANITIZED
#elif defined(__has_feature)  // clang
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || \
    __has_feature(thread_sanitizer)
#define HALFSPACE_SANITIZED
#endif
#endif

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_SANITIZED_H_
