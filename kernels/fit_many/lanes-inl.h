// Steps of the bulk builders, with one shape or one point in each lane.
#if defined(HALFSPACE_KERNELS_FIT_MANY_LANES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_LANES_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_LANES_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_LANES_INL_H_
#endif

#include <cstddef>

#include "hwy/highway.h"
#include "kernels/fit_many/kernel_table.h"
#include "kernels/fit_many/outward-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr size_t kTileObjects = 64;

// A tile is a whole number of vectors.
using FitTag = hn::CappedTag<float, kTileObjects>;

// How a builder stores a vector of bounds. A vector with a shape that could not
// be bounded always goes into the caches.
enum class StoreMode { kCached, kPastCaches };

// The lanes that could be bounded, and the value of a plane for the others.
// With kAll there are no others.
template <bool kAll, StoreMode kStore, class D, class V, class M>
HWY_INLINE void StoreWanted(D d, V value, M ok, V other, float* plane,
                            size_t i) {
  if (plane == nullptr) return;
  if constexpr (!kAll) {
    hn::StoreU(hn::IfThenElse(ok, value, other), d, plane + i);
  } else if constexpr (kStore == StoreMode::kCached) {
    hn::StoreU(value, d, plane + i);
  } else {
    hn::Stream(value, d, plane + i);
  }
}

// The limit of the sum of magnitudes. A NaN or an infinity is not below it.
template <class D>
HWY_INLINE hn::Vec<D> LargestMagnitude(D d) {
  return hn::Set(d, 0x1p125f);
}

// |x| + |y| + ... of one point per lane, in order.
template <int kDims, class D>
HWY_INLINE hn::Vec<D> Magnitude(D d, const float* const* columns, size_t i) {
  auto sum = hn::Abs(hn::LoadU(d, columns[0] + i));
  for (size_t k = 1; k < kDims; ++k) {
    sum = hn::Add(sum, hn::Abs(hn::LoadU(d, columns[k] + i)));
  }
  return sum;
}

// The sum of one point's coordinates per lane. The exact sum is at most `slack`
// away from sum + rest in 4 dimensions, and else between the neighbours of
// `sum`: docs/exactness.md has the proof.
template <int kDims, class D, class V>
HWY_INLINE void LoadSum(D d, const float* const* columns, size_t i, V& sum,
                        V& rest, V& slack) {
  sum = hn::LoadU(d, columns[0] + i);
  rest = hn::LoadU(d, columns[1] + i);
  TwoSum(sum, rest);
  slack = hn::Abs(rest);
  for (size_t k = 2; k < kDims; ++k) {
    V error = hn::LoadU(d, columns[k] + i);
    TwoSum(sum, error);
    rest = hn::Add(rest, error);
    slack = hn::Add(slack, hn::Abs(error));
  }
  slack = hn::Mul(slack, hn::Set(d, 0x1p-21f));
  if (kDims == 3) sum = hn::Add(sum, rest);
}

// D is minus the sum, rounded down and up.
template <int kDims, class D, class V>
HWY_INLINE V LowerD(D d, V sum, V rest, V slack) {
  V value = hn::Neg(sum);
  if constexpr (kDims != 4) return NextBelow(d, value);
  V error = hn::Neg(hn::Add(rest, slack));
  TwoSum(value, error);
  return hn::IfThenElse(hn::Lt(error, hn::Zero(d)), NextBelow(d, value), value);
}
template <int kDims, class D, class V>
HWY_INLINE V UpperD(D d, V sum, V rest, V slack) {
  return hn::Neg(LowerD<kDims>(d, hn::Neg(sum), hn::Neg(rest), slack));
}

// The range of D over several points per lane: each of them widens it. In 2 and
// 3 dimensions it is rounded once at the end, because rounding is monotone.
template <int kDims, class D, class V>
HWY_INLINE void WidenD(D d, const float* const* columns, size_t i, V& min,
                       V& max) {
  V sum;
  V rest;
  V slack;
  LoadSum<kDims>(d, columns, i, sum, rest, slack);
  if constexpr (kDims == 4) {
    min = hn::Min(min, LowerD<kDims>(d, sum, rest, slack));
    max = hn::Max(max, UpperD<kDims>(d, sum, rest, slack));
  } else {
    min = hn::Min(min, hn::Neg(sum));
    max = hn::Max(max, hn::Neg(sum));
  }
}

// The minimum of -0 and +0 depends on the target: make it +0.
template <class D, class V>
HWY_INLINE V PlusZero(D d, V value) {
  return hn::Add(value, hn::Zero(d));
}

template <int kDims, class D, class V>
HWY_INLINE void FinishD(D d, V& min, V& max) {
  if constexpr (kDims != 4) {
    min = NextBelow(d, min);
    max = hn::Neg(NextBelow(d, hn::Neg(max)));
  }
  min = PlusZero(d, min);
  max = PlusZero(d, max);
}

// Counts the lanes of a mask among shapes i .. count - 1; `begin` is the number
// of shape 0.
template <class D, class M>
HWY_INLINE void CountEverything(D d, M is_everything, size_t i, size_t begin,
                                kernels::FitTally& tally) {
  if (HWY_LIKELY(hn::AllFalse(d, is_everything))) return;
  tally.Count(
      hn::CountTrue(d, is_everything),
      begin + i + static_cast<size_t>(hn::FindFirstTrue(d, is_everything)));
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_LANES_INL_H_
