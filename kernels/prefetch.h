// Asking for memory early.
#ifndef HALFSPACE_KERNELS_PREFETCH_H_
#define HALFSPACE_KERNELS_PREFETCH_H_

#include "hwy/cache_control.h"

namespace halfspace::kernels {

// Into the first-level cache. gcc 12 takes a function that does nothing but ask
// for memory for one that does nothing at all, and drops it: hence the asm.
inline __attribute__((always_inline)) void Prefetch(const void* address) {
  hwy::Prefetch(static_cast<const char*>(address));
  __asm__ volatile("");
}

// Into the second level: for what must not push out what is in use.
inline __attribute__((always_inline)) void PrefetchToL2(const void* address) {
  __builtin_prefetch(address, 0, 2);
  __asm__ volatile("");
}

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_PREFETCH_H_
