// Lane masks to bits: 64 objects are one word, whatever the vector length.
#if defined(HALFSPACE_KERNELS_LANE_BITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_LANE_BITS_INL_H_
#undef HALFSPACE_KERNELS_LANE_BITS_INL_H_
#else
#define HALFSPACE_KERNELS_LANE_BITS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Bit l of the result = lane l of the mask; zero above the lanes.
template <class D>
HWY_INLINE uint64_t LaneBits(D d, hn::Mask<D> mask) {
#if HWY_TARGET == HWY_SCALAR
  (void)d;
  return mask.bits ? 1 : 0;
#else
  // The compiler keeps the buffer in a register (checked: gcc 12, clang 14).
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  uint64_t bits;
  std::memcpy(&bits, bytes, sizeof(bits));
  return bits;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_LANE_BITS_INL_H_
