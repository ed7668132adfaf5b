// Some planes of up to 64 objects, to bits: what is found out about the lanes
// of several vectors is packed into one word.
#if defined(HALFSPACE_KERNELS_WORD_TESTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_WORD_TESTS_INL_H_
#undef HALFSPACE_KERNELS_WORD_TESTS_INL_H_
#else
#define HALFSPACE_KERNELS_WORD_TESTS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/lane_bits-inl.h"
#include "kernels/lane_tests-inl.h"
#include "kernels/planes.h"

#undef HALFSPACE_PAIRWISE_PACKING
#if HWY_ARCH_ARM_A64 && HWY_TARGET == HWY_NEON
#define HALFSPACE_PAIRWISE_PACKING 1
#else
#define HALFSPACE_PAIRWISE_PACKING 0
#endif

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr size_t kWordObjects = 64;

// 64 lanes are one word, so a longer vector (uint8 on 2048-bit SVE) is capped.
template <typename T>
using WordTag = hn::CappedTag<T, kWordObjects>;

// The low kObjects bits, at least one and at most 64.
template <size_t kObjects>
inline constexpr uint64_t kLowBits = ~uint64_t{0} >> (kWordObjects - kObjects);

#if HALFSPACE_PAIRWISE_PACKING

// NEON has no instruction from lanes to bits. The masks of 16 objects are
// narrowed to bytes, of which each keeps its own bit, and bytes are added in
// pairs until eight are one: 16 additions and narrowings for a word of floats
// instead of 16 times a sum over a vector.

// A mask of lanes kBytes wide, of the 16 / kBytes objects from i on.
template <class Shape, size_t kBegin, size_t kEnd, size_t kBytes, class D,
          class Load, typename T, class... V>
HWY_INLINE uint8x16_t NarrowMask(D d, Load load, const T* const* planes,
                                 size_t i, V... query) {
  if constexpr (kBytes == sizeof(T)) {
    const hn::Repartition<uint8_t, D> d8;
    return hn::BitCast(d8,
                       hn::VecFromMask(d, Verdict<Shape, kBegin, kEnd>(
                                              d, load, planes, i, query...)))
        .raw;
  } else {
    constexpr size_t kWide = 2 * kBytes;
    const uint8x16_t low =
        NarrowMask<Shape, kBegin, kEnd, kWide>(d, load, planes, i, query...);
    const uint8x16_t high = NarrowMask<Shape, kBegin, kEnd, kWide>(
        d, load, planes, i + 16 / kWide, query...);
    if constexpr (kBytes == 1) {
      return vuzp1q_u8(low, high);
    } else if constexpr (kBytes == 2) {
      return vreinterpretq_u8_u16(
          vuzp1q_u16(vreinterpretq_u16_u8(low), vreinterpretq_u16_u8(high)));
    } else {
      return vreinterpretq_u8_u32(
          vuzp1q_u32(vreinterpretq_u32_u8(low), vreinterpretq_u32_u8(high)));
    }
  }
}

// Its own bit in each byte of 8 objects, 16 objects in all.
template <class Shape, size_t kBegin, size_t kEnd, class D, class Load,
          typename T, class... V>
HWY_INLINE uint8x16_t BitInByte(D d, Load load, const T* const* planes,
                                size_t i, V... query) {
  const uint8x16_t own = vreinterpretq_u8_u64(vdupq_n_u64(0x8040201008040201));
  return vandq_u8(
      NarrowMask<Shape, kBegin, kEnd, 1>(d, load, planes, i, query...), own);
}

// Bits of 16 or 64 objects.
template <class Shape, size_t kObjects, size_t kBegin, size_t kEnd, class D,
          class Load, typename T, class... V>
HWY_INLINE uint64_t PairwiseBits(D d, Load load, const T* const* planes,
                                 size_t i, V... query) {
  const uint8x16_t none = vdupq_n_u8(0);
  const uint8x16_t a =
      BitInByte<Shape, kBegin, kEnd>(d, load, planes, i, query...);
  uint8x16_t low;
  uint8x16_t high = none;
  if constexpr (kObjects == 64) {
    low = vpaddq_u8(
        a, BitInByte<Shape, kBegin, kEnd>(d, load, planes, i + 16, query...));
    high = vpaddq_u8(
        BitInByte<Shape, kBegin, kEnd>(d, load, planes, i + 32, query...),
        BitInByte<Shape, kBegin, kEnd>(d, load, planes, i + 48, query...));
  } else {
    low = vpaddq_u8(a, none);
  }
  const uint8x16_t quarters = vpaddq_u8(low, high);
  return vgetq_lane_u64(vreinterpretq_u64_u8(vpaddq_u8(quarters, quarters)),
                        0) &
         kLowBits<kObjects>;
}

#endif  // HALFSPACE_PAIRWISE_PACKING

// The verdicts of vectors 0, 1, ... after object i.
template <class Shape, size_t kBegin, size_t kEnd, size_t... kVector, class D,
          class Load, typename T, class... V>
HWY_INLINE uint64_t VectorBits(std::index_sequence<kVector...>, D d, Load load,
                               const T* const* planes, size_t i, V... query) {
  const size_t lanes = hn::Lanes(d);
  return (... |
          (LaneBits(d, Verdict<Shape, kBegin, kEnd>(
                           d, load, planes, i + kVector * lanes, query...))
           << (kVector * lanes)));
}

// Bits of objects i ... i + kObjects - 1 that planes [kBegin, kEnd) reject, of
// what `load` brings.
template <class Shape, size_t kObjects, size_t kBegin, size_t kEnd, class D,
          class Load, typename T, class... V>
HWY_INLINE uint64_t BitsRejectedOf(D d, Load load, const T* const* planes,
                                   size_t i, V... query) {
#if HALFSPACE_PAIRWISE_PACKING
  if constexpr (kObjects == 16 || kObjects == 64) {
    return PairwiseBits<Shape, kObjects, kBegin, kEnd>(d, load, planes, i,
                                                       query...);
  }
#endif
#if HWY_HAVE_SCALABLE
  constexpr size_t kUnroll = 1;
#else
  // Constant shifts, and compares that overlap the packing of bits; more than
  // four vectors only grow the code.
  constexpr size_t kUnroll = HWY_MIN(size_t{4}, kObjects / hn::MaxLanes(D()));
#endif
  const size_t step = kUnroll * hn::Lanes(d);
  uint64_t bits = 0;
  for (size_t l = 0; l < kObjects; l += step) {
    bits |= VectorBits<Shape, kBegin, kEnd>(std::make_index_sequence<kUnroll>(),
                                            d, load, planes, i + l, query...)
            << l;
  }
  return kVerdictIsKept ? bits ^ kLowBits<kObjects> : bits;
}

// Of the objects in the planes.
template <class Shape, size_t kObjects, size_t kBegin, size_t kEnd, class D,
          typename T, class... V>
HWY_INLINE uint64_t BitsRejected(D d, const T* const* planes, size_t i,
                                 V... query) {
  return BitsRejectedOf<Shape, kObjects, kBegin, kEnd>(d, LoadAll(), planes, i,
                                                       query...);
}

// The last word: `count` objects from i on, 0 < count < 64, with nothing read
// past them. Bits past `count` are 1: nothing past the end survives.
template <class Shape, class D, typename T, class... V>
HWY_INLINE uint64_t TailRejected(D d, const T* const* planes, size_t i,
                                 size_t count, V... query) {
  constexpr size_t kPlanes = Shape::kOrder.planes.size();
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    bits |= LaneBits(d, Verdict<Shape, 0, kPlanes>(d, LoadAll(), planes, i + l,
                                                   query...))
            << l;
  }
  if (l < count) {
    const LoadFirst load{count - l};
    bits |= LaneBits(
                d, Verdict<Shape, 0, kPlanes>(d, load, planes, i + l, query...))
            << l;
  }
  if (kVerdictIsKept) bits = ~bits;
  return bits | (~uint64_t{0} << count);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_WORD_TESTS_INL_H_
