// One plane of one vector of objects: its load and its compare.
#if defined(HALFSPACE_DETAIL_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_DETAIL_VECTORS_INL_H_
#undef HALFSPACE_DETAIL_VECTORS_INL_H_
#else
#define HALFSPACE_DETAIL_VECTORS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hwy/highway.h"

// AVX-512 compares into mask registers, and can AND what was there before.
#undef HALFSPACE_MASKED_COMPARES
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
#define HALFSPACE_MASKED_COMPARES 1
#else
#define HALFSPACE_MASKED_COMPARES 0
#endif

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Loads a full vector.
struct LoadAll {
  template <class D, typename T>
  HWY_INLINE hn::Vec<D> operator()(D d, const T* from) const {
    return hn::LoadU(d, from);
  }
};

// Aligned planes have kernels of their own on SSE4, which has no unaligned load
// within a compare and whose limit is the number of instructions. With VEX an
// aligned load is no better than any other.
inline constexpr bool kAlignedLoadsPay = HWY_TARGET == HWY_SSE4;

// Loads a full vector of a plane that begins at a multiple of its size.
struct LoadAligned {
  template <class D, typename T>
  HWY_INLINE hn::Vec<D> operator()(D d, const T* from) const {
    return hn::Load(d, from);
  }
};

// AVX2's masked loads of floats and doubles never fault, and read nothing
// outside of their mask. Highway's macro is about its other types.
template <typename T>
inline constexpr bool kMaskedLoadsAreSafe = HWY_MEM_OPS_MIGHT_FAULT == 0 ||
                                            (HWY_TARGET == HWY_AVX2 &&
                                             std::is_floating_point_v<T>);

// Loads a copy of the first `count` lanes. Not inlined: a kernel would have a
// copy for each plane.
template <class D, typename T>
HWY_NOINLINE hn::Vec<D> LoadCopy(D d, const T* from, size_t count) {
  HWY_ALIGN T copy[hn::MaxLanes(D())] = {};
  for (size_t i = 0; i < count; ++i) copy[i] = from[i];
  return hn::Load(d, copy);
}

// Loads the first `count` lanes and reads nothing past them; the others are
// unspecified. 0 < count < lanes.
struct LoadFirst {
  size_t count;

  template <class D, typename T>
  HWY_INLINE hn::Vec<D> operator()(D d, const T* from) const {
    if constexpr (kMaskedLoadsAreSafe<T>) {
      return hn::MaskedLoad(hn::FirstN(d, count), d, from);
    } else if constexpr (hn::MaxLanes(D()) == 2) {
      return hn::Set(d, from[0]);
#if HWY_TARGET != HWY_SCALAR  // which has no halves
    } else if constexpr (hn::MaxLanes(D()) == 4) {
      // The last element again where there are fewer than three.
      const hn::Half<D> d2;
      const hn::Half<decltype(d2)> d1;
      const auto first = hn::LoadU(d1, from);
      const auto second = hn::LoadU(d1, from + count / 2);
      const auto last = hn::LoadU(d1, from + count - 1);
      return hn::Combine(d, hn::ZeroExtendVector(d2, last),
                         hn::Combine(d2, second, first));
#endif
    } else {
      return LoadCopy(d, from, count);
    }
  }
};

// Whether objects above the query's value are rejected, or those below it.
// Quantized minima are stored in reverse (dispatch/planes/quantizer.cc), so
// that the lesser level rejects in every plane: AVX2 has only one compare of
// signed bytes, and it can load only its lesser side from memory.
template <bool kIsMin, typename T>
inline constexpr bool kRejectsAbove = kIsMin&& std::is_floating_point_v<T>;

// A verdict on the lanes of a vector after some planes: a mask of the rejected
// lanes, or, where compares are masked, of the kept ones. FirstVerdict tests
// one plane, NextVerdict adds another.
//
// The compare is strict and ordered, or its exact negation: bounds that touch
// and NaNs are kept.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2

// Whether a < b, as lanes of all ones: with AVX-512 Highway has only masks of
// 256 bits.
HWY_INLINE hn::Vec256<float> IsBelow(hn::Vec256<float> a, hn::Vec256<float> b) {
  return hn::Vec256<float>{_mm256_cmp_ps(a.raw, b.raw, _CMP_LT_OQ)};
}
HWY_INLINE hn::Vec256<double> IsBelow(hn::Vec256<double> a,
                                      hn::Vec256<double> b) {
  return hn::Vec256<double>{_mm256_cmp_pd(a.raw, b.raw, _CMP_LT_OQ)};
}
HWY_INLINE hn::Vec256<int8_t> IsBelow(hn::Vec256<int8_t> a,
                                      hn::Vec256<int8_t> b) {
  return hn::Vec256<int8_t>{_mm256_cmpgt_epi8(b.raw, a.raw)};
}
HWY_INLINE hn::Vec256<int16_t> IsBelow(hn::Vec256<int16_t> a,
                                       hn::Vec256<int16_t> b) {
  return hn::Vec256<int16_t>{_mm256_cmpgt_epi16(b.raw, a.raw)};
}

#endif

#if HALFSPACE_MASKED_COMPARES

// The object's value where it rejects, else the query's. Each of these
// instructions returns its second operand unless the first one is above it, or
// below: also for a NaN on either side, and for zeros of both signs.
template <bool kIsMin>
HWY_INLINE hn::Vec512<float> Rejecting(hn::Vec512<float> object,
                                       hn::Vec512<float> query) {
  return {kIsMin ? _mm512_max_ps(object.raw, query.raw)
                 : _mm512_min_ps(object.raw, query.raw)};
}
template <bool kIsMin>
HWY_INLINE hn::Vec512<double> Rejecting(hn::Vec512<double> object,
                                        hn::Vec512<double> query) {
  return {kIsMin ? _mm512_max_pd(object.raw, query.raw)
                 : _mm512_min_pd(object.raw, query.raw)};
}
template <bool kIsMin, class V>  // of levels, of which the lesser rejects
HWY_INLINE V Rejecting(V object, V query) {
  static_assert(!kRejectsAbove<kIsMin, int8_t>);
  return hn::Min(object, query);
}

// Highway has no such compare. Its mask is ANDed to the one before.
template <bool kIsMin>
HWY_INLINE __mmask16 KeptAnd(__mmask16 kept, hn::Vec512<float> object,
                             hn::Vec512<float> query) {
  return _mm512_mask_cmp_ps_mask(kept, object.raw, query.raw,
                                 kIsMin ? _CMP_NGT_UQ : _CMP_NLT_UQ);
}
template <bool kIsMin>
HWY_INLINE __mmask8 KeptAnd(__mmask8 kept, hn::Vec512<double> object,
                            hn::Vec512<double> query) {
  return _mm512_mask_cmp_pd_mask(kept, object.raw, query.raw,
                                 kIsMin ? _CMP_NGT_UQ : _CMP_NLT_UQ);
}
template <bool kIsMin>
HWY_INLINE __mmask64 KeptAnd(__mmask64 kept, hn::Vec512<int8_t> object,
                             hn::Vec512<int8_t> query) {
  static_assert(!kRejectsAbove<kIsMin, int8_t>);
  return _mm512_mask_cmp_epi8_mask(kept, object.raw, query.raw, _MM_CMPINT_NLT);
}
template <bool kIsMin>
HWY_INLINE __mmask32 KeptAnd(__mmask32 kept, hn::Vec512<int16_t> object,
                             hn::Vec512<int16_t> query) {
  static_assert(!kRejectsAbove<kIsMin, int16_t>);
  return _mm512_mask_cmp_epi16_mask(kept, object.raw, query.raw,
                                    _MM_CMPINT_NLT);
}

// A core makes one mask a cycle, but two results of Rejecting(), so the verdict
// on most planes is whether such a result is another number than the query's.
// In L1 six planes take 0.58 of the time of masks alone (Zen 5).
template <class D>
struct WideVerdict {
  __m512i different;  // bits, of each lane
  hn::Mask<D> kept;
};

// Adds the verdict of a plane. The query's value goes through the instruction
// once. So if the thread flushes subnormals, it is what is returned again, bit
// for bit.
template <bool kIsMin, class D, class V>
HWY_INLINE void AddWideVerdict(D /*d*/, bool is_first, bool by_mask, V object,
                               V query, WideVerdict<D>& verdict) {
  using Bits = decltype(hn::Mask<D>::raw);
  const hn::Repartition<uint8_t, D> d8;
  if (is_first) verdict.kept = {static_cast<Bits>(~Bits{0})};
  if (by_mask) {
    verdict.kept = {KeptAnd<kIsMin>(verdict.kept.raw, object, query)};
    return;
  }
  const auto value = Rejecting<kIsMin>(query, query);
  const __m512i a = hn::BitCast(d8, Rejecting<kIsMin>(object, value)).raw;
  const __m512i b = hn::BitCast(d8, value).raw;
  verdict.different =
      is_first ? _mm512_xor_si512(a, b)
               : _mm512_ternarylogic_epi32(verdict.different, a, b, 0xf6);
}

// The kept lanes.
template <class D>
HWY_INLINE hn::Mask<D> MaskOf(WideVerdict<D> verdict) {
  constexpr size_t kBytes = sizeof(hn::TFromD<D>);
  const __m512i v = verdict.different;
  if constexpr (kBytes == 1) {
    return {_mm512_mask_testn_epi8_mask(verdict.kept.raw, v, v)};
  } else if constexpr (kBytes == 2) {
    return {_mm512_mask_testn_epi16_mask(verdict.kept.raw, v, v)};
  } else if constexpr (kBytes == 4) {
    return {_mm512_mask_testn_epi32_mask(verdict.kept.raw, v, v)};
  } else {
    return {_mm512_mask_testn_epi64_mask(verdict.kept.raw, v, v)};
  }
}

template <class D>
HWY_INLINE hn::Mask<D> MaskOf(hn::Mask<D> kept) {
  return kept;
}

// Vectors of 256 bits are for one query (OneTag), and are compared to vectors.
template <class D>
inline constexpr bool kIsHalf = hn::MaxLanes(D()) * sizeof(hn::TFromD<D>) == 32;
template <class D>
inline constexpr bool kVerdictIsKept = !kIsHalf<D>;

// With kIsFew only one plane follows, or none. Masks alone are faster then.
template <bool kIsMin, bool kIsFew, class D, class V>
HWY_INLINE auto FirstVerdict(D d, V object, V query) {
  (void)d;
  if constexpr (kIsHalf<D>) {
    return kRejectsAbove<kIsMin, hn::TFromD<D>> ? IsBelow(query, object)
                                                : IsBelow(object, query);
  } else if constexpr (kIsFew) {
    using Bits = decltype(hn::Mask<D>::raw);
    const Bits all = static_cast<Bits>(~Bits{0});
    return hn::Mask<D>{KeptAnd<kIsMin>(all, object, query)};
  } else {
    WideVerdict<D> verdict;
    AddWideVerdict<kIsMin>(d, true, false, object, query, verdict);
    return verdict;
  }
}

template <bool kIsMin, bool kIsLast, class D, class Before, class V>
HWY_INLINE Before NextVerdict(D d, Before before, V object, V query) {
  if constexpr (kIsHalf<D>) {
    return hn::Or(before, FirstVerdict<kIsMin, true>(d, object, query));
  } else if constexpr (std::is_same_v<Before, hn::Mask<D>>) {
    return {KeptAnd<kIsMin>(before.raw, object, query)};
  } else {
    AddWideVerdict<kIsMin>(d, false, kIsLast, object, query, before);
    return before;
  }
}

#else  // HALFSPACE_MASKED_COMPARES

template <class D>
inline constexpr bool kVerdictIsKept = false;

template <class V>
HWY_INLINE auto IsAbove(V object, V query) {
  return hn::Gt(object, query);
}

#if HWY_TARGET == HWY_AVX2
// The query comes first, so that the load of the object is part of the compare.
// Highway's compare has the object first, which gcc loads by an instruction of
// its own: a simplex in L1 takes 0.165 ns then instead of 0.122 on Zen 4.
template <typename T>
HWY_INLINE hn::Mask256<T> IsAbove(hn::Vec256<T> object, hn::Vec256<T> query) {
  return {IsBelow(query, object).raw};
}
#endif

template <bool kIsMin, bool /*kIsFew*/, class D, class V>
HWY_INLINE hn::Mask<D> FirstVerdict(D /*d*/, V object, V query) {
  if constexpr (kRejectsAbove<kIsMin, hn::TFromD<D>>) {
    return IsAbove(object, query);
  } else {
    return hn::Lt(object, query);
  }
}

template <class M>
HWY_INLINE M EitherMask(M a, M b) {
#if HWY_TARGET == HWY_SVE || HWY_TARGET == HWY_SVE2 || \
    HWY_TARGET == HWY_SVE_256 || HWY_TARGET == HWY_SVE2_128
  // Highway's Or is a select, which gcc 12 splits lane by lane for bytes, and
  // on SVE_256 computes wrongly for every other 16 of them.
  return svorr_b_z(svptrue_b8(), a, b);
#else
  return hn::Or(a, b);
#endif
}

template <bool kIsMin, bool /*kIsLast*/, class D, class V>
HWY_INLINE hn::Mask<D> NextVerdict(D d, hn::Mask<D> rejected, V object,
                                   V query) {
  return EitherMask(rejected, FirstVerdict<kIsMin, true>(d, object, query));
}

#endif  // HALFSPACE_MASKED_COMPARES

// Adds the verdict of planes[0], planes[1], ... on objects i, i + 1, ..., one
// plane for each query vector; the first kMins planes are minima.
template <size_t kMins, class D, class Load, typename T, class Before, class V,
          class... Rest>
HWY_INLINE Before AddVerdicts(D d, Before before, Load load,
                              const T* const* planes, size_t i, V query,
                              Rest... rest) {
  const Before verdict = NextVerdict<(kMins > 0), sizeof...(Rest) == 0>(
      d, before, load(d, planes[0] + i), query);
  if constexpr (sizeof...(Rest) == 0) {
    return verdict;
  } else {
    constexpr size_t kLeft = kMins > 0 ? kMins - 1 : 0;
    return AddVerdicts<kLeft>(d, verdict, load, planes + 1, i, rest...);
  }
}

template <size_t kMins, class D, class Load, typename T, class V, class... Rest>
HWY_INLINE auto Verdict(D d, Load load, const T* const* planes, size_t i,
                        V query, Rest... rest) {
  const auto first = FirstVerdict<(kMins > 0), (sizeof...(Rest) < 2)>(
      d, load(d, planes[0] + i), query);
  if constexpr (sizeof...(Rest) == 0) {
    return first;
  } else {
    constexpr size_t kLeft = kMins > 0 ? kMins - 1 : 0;
    return AddVerdicts<kLeft>(d, first, load, planes + 1, i, rest...);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_DETAIL_VECTORS_INL_H_
