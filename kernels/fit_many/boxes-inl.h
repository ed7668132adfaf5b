// Bounds of many boxes. X, Y and Z are copied. D is the D of two opposite
// corners.
#if defined(HALFSPACE_KERNELS_FIT_MANY_BOXES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_BOXES_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_BOXES_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_BOXES_INL_H_
#endif

#include <cfloat>
#include <cmath>
#include <cstddef>

#include "hwy/highway.h"
#include "kernels/fit_many/tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <int kDimensions>
struct BoxBuilder {
  using Tag = FitTag;
  static constexpr int kDims = kDimensions;
  static constexpr size_t kColumns = 2 * kDims;

  bool inverted_is_empty;

  void Read(InputTile<kColumns>& tile, const kernels::FitJob& job, size_t begin,
            size_t count) const {
    tile.Read(job, begin, count);
  }

  template <StoreMode kStore, class D>
  HWY_INLINE void FitVector(D d, const float* const* columns,
                            const OutputPlanes<kDims>& out, size_t i,
                            size_t begin, kernels::FitTally& tally) const {
    const float* const* high_columns = columns + kDims;
    const auto largest = LargestMagnitude(d);
    auto ok = hn::And(hn::Le(Magnitude<kDims>(d, columns, i), largest),
                      hn::Le(Magnitude<kDims>(d, high_columns, i), largest));
    for (size_t k = 0; k < kDims; ++k) {
      ok = hn::And(ok, hn::Le(hn::LoadU(d, columns[k] + i),
                              hn::LoadU(d, high_columns[k] + i)));
    }
    // The minimum of a box that cannot be bounded.
    const auto everything = hn::Set(d, -FLT_MAX);
    if (HWY_LIKELY(hn::AllTrue(d, ok))) {
      StoreBounds<true, kStore>(d, columns, out, i, ok, everything);
    } else {
      const auto is_empty = EmptyLanes(d, columns, i);
      CountEverything(d, hn::Not(hn::Or(ok, is_empty)), i, begin, tally);
      const auto other =
          hn::IfThenElse(is_empty, hn::Set(d, INFINITY), everything);
      StoreBounds<false, kStore>(d, columns, out, i, ok, other);
    }
  }

 private:
  template <bool kAll, StoreMode kStore, class D, class V, class M>
  static HWY_INLINE void StoreBounds(D d, const float* const* columns,
                                     const OutputPlanes<kDims>& out, size_t i,
                                     M ok, V other) {
    const float* const* high_columns = columns + kDims;
    for (size_t k = 0; k < kDims; ++k) {
      StoreWanted<kAll, kStore>(d, hn::LoadU(d, columns[k] + i), ok, other,
                                out.min(k), i);
      StoreWanted<kAll, kStore>(d, hn::LoadU(d, high_columns[k] + i), ok,
                                hn::Neg(other), out.max(k), i);
    }
    // D falls as the coordinates rise: its extremes are at the two corners.
    V sum;
    V rest;
    V slack;
    if (out.min(kDims) != nullptr) {
      LoadSum<kDims>(d, high_columns, i, sum, rest, slack);
      StoreWanted<kAll, kStore>(d, LowerD<kDims>(d, sum, rest, slack), ok,
                                other, out.min(kDims), i);
    }
    if (out.max(kDims) != nullptr) {
      LoadSum<kDims>(d, columns, i, sum, rest, slack);
      StoreWanted<kAll, kStore>(d, UpperD<kDims>(d, sum, rest, slack), ok,
                                hn::Neg(other), out.max(kDims), i);
    }
  }

  // Boxes without points: all minima FLT_MAX or more and all maxima -FLT_MAX or
  // less, or, if the options say so, any minimum above its maximum and no NaN.
  template <class D>
  hn::Mask<D> EmptyLanes(D d, const float* const* columns, size_t i) const {
    const auto most = hn::Set(d, FLT_MAX);
    auto is_inverted = hn::Lt(most, most);
    auto is_number = hn::Not(is_inverted);
    auto is_canonical = is_number;
    for (size_t k = 0; k < kDims; ++k) {
      const auto low = hn::LoadU(d, columns[k] + i);
      const auto high = hn::LoadU(d, columns[kDims + k] + i);
      is_inverted = hn::Or(is_inverted, hn::Gt(low, high));
      is_number =
          hn::And(is_number, hn::And(hn::Eq(low, low), hn::Eq(high, high)));
      is_canonical =
          hn::And(is_canonical,
                  hn::And(hn::Ge(low, most), hn::Le(high, hn::Neg(most))));
    }
    return inverted_is_empty ? hn::And(is_inverted, is_number) : is_canonical;
  }
};

template <int kDims>
kernels::FitTally FitBoxes(const kernels::FitJob& job) {
  return FitAll(BoxBuilder<kDims>{job.inverted_is_empty}, job,
                job.columns.stride == 1);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_BOXES_INL_H_
