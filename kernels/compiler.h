// What compilers spell differently in kernels and below: attributes, unrolling,
// prefetching, std::bit_cast.
#ifndef HALFSPACE_KERNELS_COMPILER_H_
#define HALFSPACE_KERNELS_COMPILER_H_

#if defined(__GNUC__) || defined(__clang__)
#define HALFSPACE_NOINLINE __attribute__((noinline))
#define HALFSPACE_ALWAYS_INLINE inline __attribute__((always_inline))
// Unrolls the next loop.
#define HALFSPACE_UNROLL _Pragma("GCC unroll 16")
#else  // MSVC
#include <intrin.h>
#define HALFSPACE_NOINLINE __declspec(noinline)
#define HALFSPACE_ALWAYS_INLINE __forceinline
#define HALFSPACE_UNROLL
#endif

namespace halfspace::kernels {

// std::bit_cast, which libc++ has from version 14 on.
template <typename To, typename From>
constexpr To BitCast(const From& from) {
  return __builtin_bit_cast(To, from);
}

// Into the first-level cache. The asm is there because gcc 12 removes a
// function that only prefetches, as if it had no effect.
HALFSPACE_ALWAYS_INLINE void Prefetch(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address, 0, 3);
  __asm__ volatile("");
#elif defined(_M_X64)
  _mm_prefetch(static_cast<const char*>(address), _MM_HINT_T0);
#else
  __prefetch(address);
#endif
}

// Into the second level: for data that must not evict what is in use.
HALFSPACE_ALWAYS_INLINE void PrefetchToL2(const void* address) {
#if defined(__GNUC__) || defined(__clang__)
  __builtin_prefetch(address, 0, 2);
  __asm__ volatile("");
#elif defined(_M_X64)
  _mm_prefetch(static_cast<const char*>(address), _MM_HINT_T1);
#else
  __prefetch(address);
#endif
}

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_COMPILER_H_
