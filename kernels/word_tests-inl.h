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
#include "kernels/narrow_masks-inl.h"
#include "kernels/planes.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Bit l of the result = lane l of the verdict; zero above the lanes.
template <class D>
HWY_INLINE uint64_t VerdictBits(D d, VerdictOf<D> verdict) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (hn::MaxLanes(D()) == 8 && sizeof(hn::TFromD<D>) == 4) {
    // As LaneBits, without an instruction that clears what is clear.
    return static_cast<uint32_t>(_mm256_movemask_ps(VectorOf(d, verdict).raw));
  }
#endif
#if HALFSPACE_MASKED_COMPARES
  if constexpr (kIsHalf<D>)
    return LaneBits(d, hn::MaskFromVec(verdict));
  else
#endif
    return LaneBits(d, verdict);
}

// The verdicts of vectors 0, 1, ... after object i.
template <class Shape, size_t kBegin, size_t kEnd, size_t... kVector, class D,
          class Load, typename T, class... V>
HWY_INLINE uint64_t VectorBits(std::index_sequence<kVector...>, D d, Load load,
                               const T* const* planes, size_t i, V... query) {
  const size_t lanes = hn::Lanes(d);
  return (... |
          (VerdictBits(d, Verdict<Shape, kBegin, kEnd>(
                              d, load, planes, i + kVector * lanes, query...))
           << (kVector * lanes)));
}

// Bits of objects i ... i + kObjects - 1 that planes [kBegin, kEnd) reject, of
// what `load` brings.
template <class Shape, size_t kObjects, size_t kBegin, size_t kEnd,
          Pack kPack = kNearPack, class D, class Load, typename T, class... V>
HWY_INLINE uint64_t BitsRejected(D d, Load load, const T* const* planes,
                                 size_t i, V... query) {
#if HALFSPACE_NARROW_MASKS
  if constexpr (kPack == Pack::kInstructions && kIsNarrowed<kObjects, D>) {
    return NarrowedBits<Shape, kObjects, kBegin, kEnd>(d, load, planes, i,
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
  return kVerdictIsKept<D> ? bits ^ kLowBits<kObjects> : bits;
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
    bits |= VerdictBits(d, Verdict<Shape, 0, kPlanes>(d, LoadAll(), planes,
                                                      i + l, query...))
            << l;
  }
  if (l < count) {
    const LoadFirst load{count - l};
    bits |= VerdictBits(
                d, Verdict<Shape, 0, kPlanes>(d, load, planes, i + l, query...))
            << l;
  }
  if (kVerdictIsKept<D>) bits = ~bits;
  return bits | (~uint64_t{0} << count);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_WORD_TESTS_INL_H_
