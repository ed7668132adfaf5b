// Bounds of many spheres. D has a square root in it, and is computed in double.
#if defined(HALFSPACE_KERNELS_FIT_MANY_SPHERES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_SPHERES_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_SPHERES_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_SPHERES_INL_H_
#endif

#include <cfloat>
#include <cstddef>

#include "hwy/highway.h"
#include "kernels/fit_many/root_of_dims.h"
#include "kernels/fit_many/tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// Doubles, and as many floats.
using WideTag = hn::CappedTag<double, kTileObjects>;
using NarrowTag = hn::Rebind<float, WideTag>;

// The largest float that is not above a double, in each lane.
HWY_INLINE hn::Vec<NarrowTag> LowerFloat(hn::Vec<WideTag> value) {
  using W = hn::Vec<WideTag>;
  const WideTag dw;
  const NarrowTag dn;
  const auto nearest = hn::DemoteTo(dn, value);
  const W back = hn::PromoteTo(dw, nearest);
  const W below = hn::PromoteTo(dw, NextBelow(dn, nearest));
  return hn::DemoteTo(dn, hn::IfThenElse(hn::Gt(back, value), below, back));
}

template <int kDimensions>
struct SphereBuilder {
  using Tag = NarrowTag;
  static constexpr int kDims = kDimensions;
  static constexpr size_t kColumns = kDims + 1;

  void Read(InputTile<kColumns>& tile, const kernels::FitJob& job, size_t begin,
            size_t count) const {
    tile.Read(job, begin, count);
  }

  template <StoreMode kStore, class D>
  HWY_INLINE void FitVector(D d, const float* const* columns,
                            const OutputPlanes<kDims>& out, size_t i,
                            size_t begin, kernels::FitTally& tally) const {
    const auto radius = hn::LoadU(d, columns[kDims] + i);
    const auto ok = hn::And(
        hn::Ge(radius, hn::Zero(d)),
        hn::Le(hn::Add(Magnitude<kDims>(d, columns, i), hn::Abs(radius)),
               LargestMagnitude(d)));
    if (HWY_LIKELY(hn::AllTrue(d, ok))) {
      StoreBounds<true, kStore>(d, columns, out, i, ok, radius);
    } else {
      CountEverything(d, hn::Not(ok), i, begin, tally);
      StoreBounds<false, kStore>(d, columns, out, i, ok, radius);
    }
  }

 private:
  template <bool kAll, StoreMode kStore, class D, class V, class M>
  static HWY_INLINE void StoreBounds(D d, const float* const* columns,
                                     const OutputPlanes<kDims>& out, size_t i,
                                     M ok, V radius) {
    const V lowest = hn::Set(d, -FLT_MAX);
    const V highest = hn::Set(d, FLT_MAX);
    for (size_t k = 0; k < kDims; ++k) {
      const V center = hn::LoadU(d, columns[k] + i);
      StoreWanted<kAll, kStore>(d, Difference(d, center, radius), ok, lowest,
                                out.min(k), i);
      StoreWanted<kAll, kStore>(d,
                                hn::Neg(Difference(d, hn::Neg(center), radius)),
                                ok, highest, out.max(k), i);
    }
    // The bounds of D are -(x + y + ...) plus and minus the reach, in double.
    const WideTag dw;
    auto reach = hn::Mul(hn::PromoteTo(dw, radius),
                         hn::Set(dw, kernels::kRootOfDims<kDims>));
    auto sum = hn::Zero(dw);
    auto magnitude = reach;
    for (size_t k = 0; k < kDims; ++k) {
      const auto x = hn::PromoteTo(dw, hn::LoadU(d, columns[k] + i));
      sum = hn::Add(sum, x);
      magnitude = hn::Add(magnitude, hn::Abs(x));
    }
    // Each of up to six roundings is worth 2^-53 of all magnitudes.
    reach = hn::Add(reach, hn::Mul(magnitude, hn::Set(dw, 0x1p-50)));
    if (out.min(kDims) != nullptr) {
      const V low = LowerFloat(hn::Neg(hn::Add(sum, reach)));
      StoreWanted<kAll, kStore>(d, low, ok, lowest, out.min(kDims), i);
    }
    if (out.max(kDims) != nullptr) {
      const V high = hn::Neg(LowerFloat(hn::Sub(sum, reach)));
      StoreWanted<kAll, kStore>(d, high, ok, highest, out.max(kDims), i);
    }
  }

  // a - b, rounded down.
  template <class D, class V>
  static HWY_INLINE V Difference(D d, V a, V b) {
    V sum = a;
    V rest = hn::Neg(b);
    TwoSum(sum, rest);
    return hn::IfThenElse(hn::Lt(rest, hn::Zero(d)), NextBelow(d, sum), sum);
  }
};

template <int kDims>
kernels::FitTally FitSpheres(const kernels::FitJob& job) {
  return FitAll(SphereBuilder<kDims>(), job,
                /*is_read_in_place=*/job.columns.stride == 1);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_SPHERES_INL_H_
