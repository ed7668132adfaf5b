// Masks of a vector's worth of bytes, one an object, and those as bits: for
// targets where the bits of each vector by themselves cost more.
#if defined(HALFSPACE_DETAIL_NARROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_DETAIL_NARROW_INL_H_
#undef HALFSPACE_DETAIL_NARROW_INL_H_
#else
#define HALFSPACE_DETAIL_NARROW_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/vectors-inl.h"
#include "hwy/highway.h"

#undef HALFSPACE_NARROW_MASKS
#if HWY_ARCH_ARM_A64 && HWY_TARGET == HWY_NEON
#define HALFSPACE_NARROW_MASKS 1
#elif HWY_ARCH_X86 && (HWY_TARGET <= HWY_AVX2 || HWY_TARGET == HWY_SSE4 || \
                       HWY_TARGET == HWY_SSSE3)
#define HALFSPACE_NARROW_MASKS 1
#else
#define HALFSPACE_NARROW_MASKS 0
#endif

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr size_t kWordObjects = 64;

// 64 lanes are one word, so a longer vector (uint8 on 2048-bit SVE) is capped.
template <typename T>
using WordTag = hn::CappedTag<T, kWordObjects>;

// The vectors of one query on planes out of the first-level cache, unless 512
// bits are known to pay (dispatch/targets/detect_targets.h). With AVX-512, 256
// bits take 0.8 to 0.9 of the time of 512 in L2 (Zen 5), and as long beyond.
#if HALFSPACE_MASKED_COMPARES
template <typename T>
using OneTag = hn::CappedTag<T, 32 / sizeof(T)>;
#else
template <typename T>
using OneTag = WordTag<T>;
#endif

// The low kObjects bits, at least one and at most 64.
template <size_t kObjects>
inline constexpr uint64_t kLowBits = ~uint64_t{0} >> (kWordObjects - kObjects);

// What packing saves. With 256 bits narrowing takes fewer instructions and a
// few more vector operations: from L2 on it is 6 % faster, but 4 % slower in
// L1, where the vector units are the limit (Zen 4).
enum class Pack { kInstructions, kVectorOps };
inline constexpr Pack kInCachePack = HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
                                         ? Pack::kVectorOps
                                         : Pack::kInstructions;

#if HALFSPACE_NARROW_MASKS

inline constexpr size_t kNarrowObjects = HWY_MIN(32, HWY_MAX_BYTES);
using MaskBytes = hn::Vec<hn::FixedTag<uint8_t, kNarrowObjects>>;

// From lanes of kBytes to lanes of half that. Of 256 bits in each half by
// itself: BitsOfBytes mends the order.
template <size_t kBytes>
HWY_INLINE MaskBytes NarrowPair(MaskBytes low, MaskBytes high) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (kBytes == 2) {
    return MaskBytes{_mm256_packs_epi16(low.raw, high.raw)};
  } else {
    return MaskBytes{_mm256_packs_epi32(low.raw, high.raw)};
  }
#elif HWY_ARCH_X86
  if constexpr (kBytes == 2) {
    return MaskBytes{_mm_packs_epi16(low.raw, high.raw)};
  } else if constexpr (kBytes == 4) {
    return MaskBytes{_mm_packs_epi32(low.raw, high.raw)};
  } else {
    return MaskBytes{_mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(low.raw),
                                                     _mm_castsi128_ps(high.raw),
                                                     _MM_SHUFFLE(2, 0, 2, 0)))};
  }
#else
  if constexpr (kBytes == 2) {
    return MaskBytes{vuzp1q_u8(low.raw, high.raw)};
  } else if constexpr (kBytes == 4) {
    return MaskBytes{vreinterpretq_u8_u16(vuzp1q_u16(
        vreinterpretq_u16_u8(low.raw), vreinterpretq_u16_u8(high.raw)))};
  } else {
    return MaskBytes{vreinterpretq_u8_u32(vuzp1q_u32(
        vreinterpretq_u32_u8(low.raw), vreinterpretq_u32_u8(high.raw)))};
  }
#endif
}

template <class D, class Verdict>
HWY_INLINE hn::Vec<D> VectorOf(D d, Verdict verdict) {
#if HALFSPACE_MASKED_COMPARES
  (void)d;
  return verdict;
#else
  return hn::VecFromMask(d, verdict);
#endif
}

// A mask of lanes kBytes wide, of the kNarrowObjects / kBytes objects from i
// on.
template <size_t kMins, size_t kBytes, class D, class Load, typename T,
          class... V>
HWY_INLINE MaskBytes NarrowMask(D d, Load load, const T* const* planes,
                                size_t i, V... query) {
  if constexpr (kBytes == sizeof(T)) {
    const hn::Repartition<uint8_t, D> d8;
    return hn::BitCast(
        d8, VectorOf(d, Verdict<kMins>(d, load, planes, i, query...)));
  } else {
    constexpr size_t kWide = 2 * kBytes;
    const MaskBytes low =
        NarrowMask<kMins, kWide>(d, load, planes, i, query...);
    const MaskBytes high = NarrowMask<kMins, kWide>(
        d, load, planes, i + kNarrowObjects / kWide, query...);
    return NarrowPair<kWide>(low, high);
  }
}

#if HWY_ARCH_X86

// Bits of bytes that were narrowed from lanes of kBytes.
template <size_t kBytes>
HWY_INLINE uint32_t BitsOfBytes(MaskBytes bytes) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  __m256i ordered = bytes.raw;
  if constexpr (kBytes == 2) {
    ordered = _mm256_permute4x64_epi64(ordered, _MM_SHUFFLE(3, 1, 2, 0));
  } else if constexpr (kBytes == 4) {
    const __m256i order = _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7);
    ordered = _mm256_permutevar8x32_epi32(ordered, order);
  }
  return static_cast<uint32_t>(_mm256_movemask_epi8(ordered));
#else
  return static_cast<uint32_t>(_mm_movemask_epi8(bytes.raw));
#endif
}

// Doubles of 256 bits would need one more permutation.
template <size_t kObjects, class D>
inline constexpr bool kIsNarrowed =
    kObjects % kNarrowObjects == 0 &&
    hn::MaxLanes(D()) * sizeof(hn::TFromD<D>) == kNarrowObjects &&
    (kNarrowObjects == 16 || sizeof(hn::TFromD<D>) <= sizeof(float));

// For a word of floats SSE4 needs 12 narrowings and 4 moves of bits instead of
// 16 moves, each with a shift and an OR. With 256 bits it is 6 narrowings, 2
// permutations and 2 moves instead of 8 moves.
template <size_t kMins, size_t kObjects, class D, class Load, typename T,
          class... V>
HWY_INLINE uint64_t NarrowedBits(D d, Load load, const T* const* planes,
                                 size_t i, V... query) {
  uint64_t bits = 0;
  for (size_t l = 0; l < kObjects; l += kNarrowObjects) {
    bits |= uint64_t{BitsOfBytes<sizeof(T)>(
                NarrowMask<kMins, 1>(d, load, planes, i + l, query...))}
            << l;
  }
  return bits;
}

#else  // HWY_ARCH_X86

// NEON has no instruction that moves lanes to bits. Each of the bytes of 16
// objects is masked to its own bit, and bytes are added in pairs until eight
// have become one. A word of floats takes 16 additions and narrowings, instead
// of 16 sums over a vector.

template <size_t kObjects, class D>
inline constexpr bool kIsNarrowed =
    kObjects == kNarrowObjects || kObjects == kWordObjects;

// Its own bit in each byte of 8 objects, 16 objects in all.
template <size_t kMins, class D, class Load, typename T, class... V>
HWY_INLINE uint8x16_t BitInByte(D d, Load load, const T* const* planes,
                                size_t i, V... query) {
  const uint8x16_t own = vreinterpretq_u8_u64(vdupq_n_u64(0x8040201008040201));
  return vandq_u8(NarrowMask<kMins, 1>(d, load, planes, i, query...).raw, own);
}

// Bits of 16 or 64 objects.
template <size_t kMins, size_t kObjects, class D, class Load, typename T,
          class... V>
HWY_INLINE uint64_t NarrowedBits(D d, Load load, const T* const* planes,
                                 size_t i, V... query) {
  const uint8x16_t none = vdupq_n_u8(0);
  const uint8x16_t a = BitInByte<kMins>(d, load, planes, i, query...);
  uint8x16_t low;
  uint8x16_t high = none;
  if constexpr (kObjects == 64) {
    low = vpaddq_u8(a, BitInByte<kMins>(d, load, planes, i + 16, query...));
    high = vpaddq_u8(BitInByte<kMins>(d, load, planes, i + 32, query...),
                     BitInByte<kMins>(d, load, planes, i + 48, query...));
  } else {
    low = vpaddq_u8(a, none);
  }
  const uint8x16_t quarters = vpaddq_u8(low, high);
  return vgetq_lane_u64(vreinterpretq_u64_u8(vpaddq_u8(quarters, quarters)),
                        0) &
         kLowBits<kObjects>;
}

#endif  // HWY_ARCH_X86

#endif  // HALFSPACE_NARROW_MASKS

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_DETAIL_NARROW_INL_H_
