// Sums over words of survivors.
#if defined(HALFSPACE_KERNELS_WORD_COUNTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_WORD_COUNTS_INL_H_
#undef HALFSPACE_KERNELS_WORD_COUNTS_INL_H_
#else
#define HALFSPACE_KERNELS_WORD_COUNTS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// Set bits in `count` words. Per target: the baseline of x86 has no popcnt, and
// without it counting costs half of what the test does.
inline size_t CountBits(const uint64_t* words, size_t count) {
  size_t bits = 0;
  for (size_t w = 0; w < count; ++w) bits += hwy::PopCount(words[w]);
  return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_WORD_COUNTS_INL_H_
