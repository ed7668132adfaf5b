// Prefetching: memory is brought into a cache before it is read.
#ifndef HALFSPACE_KERNELS_PREFETCH_H_
#define HALFSPACE_KERNELS_PREFETCH_H_

#include "hwy/cache_control.h"

namespace halfspace::kernels {

// Into the first-level cache. The asm is there because gcc 12 removes a
// function that only prefetches, as if it had no effect.
inline __attribute__((always_inline)) void Prefetch(const void* address) {
  hwy::Prefetch(static_cast<const char*>(address));
  __asm__ volatile("");
}

// Into the second level: for data that must not evict what is in use.
inline __attribute__((always_inline)) void PrefetchToL2(const void* address) {
  __builtin_prefetch(address, 0, 2);
  __asm__ volatile("");
}

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_PREFETCH_H_
