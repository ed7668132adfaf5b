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

// The unsigned integer with one bit per lane, at least a byte.
template <size_t kLanes>
struct LaneBitsType {
  using type = uint64_t;
};
template <>
struct LaneBitsType<32> {
  using type = uint32_t;
};
template <>
struct LaneBitsType<16> {
  using type = uint16_t;
};
template <>
struct LaneBitsType<8> {
  using type = uint8_t;
};
template <>
struct LaneBitsType<4> {
  using type = uint8_t;
};
template <>
struct LaneBitsType<2> {
  using type = uint8_t;
};

// Bit l of the result = lane l of the mask; zero above the lanes.
//
// StoreMaskBits may write 8 bytes, of which only those of the lanes count. Read
// with their own type they stay in a register; as a zeroed 8-byte buffer gcc
// merges each byte into a reloaded constant.
template <class D>
HWY_INLINE uint64_t LaneBits(D d, hn::Mask<D> mask) {
#if HWY_TARGET == HWY_SCALAR
  (void)d;
  return mask.bits ? 1 : 0;
#else
#if HWY_HAVE_SCALABLE
  uint8_t bytes[8] = {};
  uint64_t bits;
#else
  uint8_t bytes[8];
  typename LaneBitsType<hn::MaxLanes(D())>::type bits;
#endif
  hn::StoreMaskBits(d, mask, bytes);
  std::memcpy(&bits, bytes, sizeof(bits));
  return bits;
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_LANE_BITS_INL_H_
