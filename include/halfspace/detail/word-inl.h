// From planes of up to 64 objects to the bits of a word: 1 = survives. Verdicts
// on the lanes of several vectors are packed into one word. Internal:
// kernels-inl.h has what programs call.
#if defined(HALFSPACE_DETAIL_WORD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_DETAIL_WORD_INL_H_
#undef HALFSPACE_DETAIL_WORD_INL_H_
#else
#define HALFSPACE_DETAIL_WORD_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "halfspace/detail/narrow-inl.h"
#include "halfspace/detail/vectors-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The values of a query. Minima of objects are compared with its maxima.
template <typename T>
struct QueryValues {
  const T* max;
  const T* min;  // if objects have maxima

  // What plane p is compared with, after kMins minima.
  template <size_t kMins>
  HWY_INLINE T Of(size_t p) const {
    return p < kMins ? max[p] : min[p - kMins];
  }
};

// `query` is that of kernels.h: maxima after minima, or maxima alone.
template <size_t kMins, size_t kMaxs, typename T>
HWY_INLINE QueryValues<T> ValuesOf(const T* query) {
  return {query + (kMaxs == 0 ? 0 : kMins), query};
}

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

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
inline constexpr bool kIsLittleEndian = false;
#else
inline constexpr bool kIsLittleEndian = true;
#endif

// Between a word and the bytes of a mask: Highway keeps lane 0 in the lowest
// bit of the first byte, on a big-endian machine, too.
template <typename T>
HWY_INLINE T WordOfBytes(const uint8_t* bytes) {
  T word = 0;
  if constexpr (kIsLittleEndian) {
    std::memcpy(&word, bytes, sizeof(word));
  } else {
    for (size_t b = sizeof(word); b-- > 0;) {
      word = static_cast<T>(word << 7 << 1 | bytes[b]);
    }
  }
  return word;
}
template <class D>
HWY_INLINE hn::Mask<D> MaskOfBits(D d, uint64_t bits) {
  if constexpr (!kIsLittleEndian) {
    uint8_t bytes[sizeof(bits)];
    std::memcpy(bytes, &bits, sizeof(bits));
    bits = WordOfBytes<uint64_t>(bytes);
  }
  return hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&bits));
}

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
  using Bits = uint64_t;
#else
  uint8_t bytes[8];
  using Bits = typename LaneBitsType<hn::MaxLanes(D())>::type;
#endif
  hn::StoreMaskBits(d, mask, bytes);
  return WordOfBytes<Bits>(bytes);
#endif
}

// Bit l of the result = lane l of the verdict; zero above the lanes.
template <class D, class Verdict>
HWY_INLINE uint64_t VerdictBits(D d, Verdict verdict) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (hn::MaxLanes(D()) == 8 && sizeof(hn::TFromD<D>) == 4) {
    // As LaneBits, without an instruction that clears bits that are 0 already.
    return static_cast<uint32_t>(_mm256_movemask_ps(VectorOf(d, verdict).raw));
  }
#endif
#if HALFSPACE_MASKED_COMPARES
  if constexpr (kIsHalf<D>) {
    return LaneBits(d, hn::MaskFromVec(verdict));
  } else {
    return LaneBits(d, MaskOf<D>(verdict));
  }
#else
  return LaneBits(d, verdict);
#endif
}

// The verdicts of vectors 0, 1, ... after object i.
template <size_t kMins, size_t... kVector, class D, class Load, typename T,
          class... V>
HWY_INLINE uint64_t VectorBits(std::index_sequence<kVector...>, D d, Load load,
                               const T* const* planes, size_t i, V... query) {
  const size_t lanes = hn::Lanes(d);
  return (... | (VerdictBits(d, Verdict<kMins>(d, load, planes,
                                               i + kVector * lanes, query...))
                 << (kVector * lanes)));
}

// The bits of those of objects i ... i + kObjects - 1 that survive planes[0],
// planes[1], ..., each loaded by `load` and compared with its query vector. The
// first kMins planes are minima.
template <size_t kMins, size_t kObjects = kWordObjects,
          Pack kPack = kInCachePack, class D, class Load, typename T,
          class... V>
HWY_INLINE uint64_t KeptBits(D d, Load load, const T* const* planes, size_t i,
                             V... query) {
#if HALFSPACE_NARROW_MASKS
  if constexpr (kPack == Pack::kInstructions && kIsNarrowed<kObjects, D>) {
    return NarrowedBits<kMins, kObjects>(d, load, planes, i, query...) ^
           kLowBits<kObjects>;
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
    bits |= VectorBits<kMins>(std::make_index_sequence<kUnroll>(), d, load,
                              planes, i + l, query...)
            << l;
  }
  return kVerdictIsKept<D> ? bits : bits ^ kLowBits<kObjects>;
}

// The last word: objects i ... end - 1, at least one and fewer than 64. No
// others are read, except that with kReadsBack the vector before them may be.
// Bits past the last object are 0.
template <size_t kMins, bool kReadsBack, class D, typename T, class... V>
HWY_INLINE uint64_t KeptTail(D d, const T* const* planes, size_t i, size_t end,
                             V... query) {
  constexpr std::index_sequence<0> kOne;
  const size_t lanes = hn::Lanes(d);
  const uint64_t past_end = ~uint64_t{0} << (end - i);
  const bool has_vector = kReadsBack || end - i >= lanes;
  uint64_t bits = 0;
  size_t l = 0;
  if constexpr (hn::MaxLanes(D()) == 2 || hn::MaxLanes(D()) == 4) {
    // Groups of 16 take fewer instructions than vectors of 4.
    for (; i + 16 <= end; i += 16, l += 16) {
      const uint64_t kept =
          KeptBits<kMins, 16>(d, LoadAll(), planes, i, query...);
      bits |= (kept ^ kLowBits<16>) << l;
    }
  }
  for (; i + lanes <= end; i += lanes, l += lanes) {
    bits |= VectorBits<kMins>(kOne, d, LoadAll(), planes, i, query...) << l;
  }
  if (HWY_MEM_OPS_MIGHT_FAULT && i < end && has_vector) {
    // The last vector begins as many objects earlier as it lacks, and tests
    // these again.
    const size_t lacks = i + lanes - end;
    bits |=
        VectorBits<kMins>(kOne, d, LoadAll(), planes, i - lacks, query...) >>
        lacks << l;
  } else if (i < end) {
    const LoadFirst load{(end - i) % kWordObjects};
    bits |= VectorBits<kMins>(kOne, d, load, planes, i, query...) << l;
  }
  if (!kVerdictIsKept<D>) bits = ~bits;
  return bits & ~past_end;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_DETAIL_WORD_INL_H_
