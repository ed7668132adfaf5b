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

// The largest float not above value + rest, as a double; `rest` has the sign of
// what is missing.
template <class V>
HWY_INLINE V LowerFloat(V value, V rest) {
  const WideTag dw;
  const NarrowTag dn;
  const auto nearest = hn::DemoteTo(dn, value);
  const V back = hn::PromoteTo(dw, nearest);
  const auto is_above =
      hn::Or(hn::Gt(back, value),
             hn::And(hn::Eq(back, value), hn::Lt(rest, hn::Zero(dw))));
  return hn::IfThenElse(is_above, hn::PromoteTo(dw, NextBelow(dn, nearest)),
                        back);
}

template <int kDimensions, Rounding kRounding>
struct SphereBuilder {
  using Tag = NarrowTag;
  static constexpr int kDims = kDimensions;
  static constexpr size_t kColumns = kDims + 1;

  void Read(InputTile<kColumns>& tile, const kernels::FitJob& job, size_t begin,
            size_t count) const {
    tile.Read(job, begin, count);
  }

  template <Store kStore, class D>
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
  template <bool kAll, Store kStore, class D, class V, class M>
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
    if (out.min(kDims) != nullptr) {
      const V low = LowestD(d, columns, i, hn::Set(WideTag(), -1.0));
      StoreWanted<kAll, kStore>(d, low, ok, lowest, out.min(kDims), i);
    }
    if (out.max(kDims) != nullptr) {
      const V high = hn::Neg(LowestD(d, columns, i, hn::Set(WideTag(), 1.0)));
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

  static HWY_INLINE hn::Vec<WideTag> Wide(const float* column, size_t i) {
    return hn::PromoteTo(WideTag(), hn::LoadU(NarrowTag(), column + i));
  }

  // The minimum of D for sign -1, of -D for sign 1: sign * (x + y + ...) minus
  // radius * sqrt(kDims), rounded down.
  template <class D, class W>
  static HWY_INLINE hn::Vec<D> LowestD(D dn, const float* const* columns,
                                       size_t i, W sign) {
    const WideTag d;
    const W x = hn::Mul(sign, Wide(columns[0], i));
    const W y = hn::Mul(sign, Wide(columns[1], i));
    const W radius = Wide(columns[kDims], i);
    if constexpr (kDims == 2) {
      return hn::DemoteTo(dn, Lowest(d, radius, x, y));
    } else {
      const W z = hn::Mul(sign, Wide(columns[2], i));
      if constexpr (kDims == 3) {
        return hn::DemoteTo(dn, Lowest(d, radius, x, y, z));
      } else {
        const W w = hn::Mul(sign, Wide(columns[3], i));
        return hn::DemoteTo(dn, Lowest(d, radius, x, y, z, w));
      }
    }
  }

  template <class D, class W, class... Ws>
  static HWY_INLINE W Lowest(D d, W radius, W x, Ws... others) {
    constexpr kernels::RootOfDims kRoot = kernels::kRootOfDims<kDims>;
    if constexpr (kRounding == Rounding::kTightest) {
      // A float times 29 bits is exact in double.
      const W first = hn::Neg(hn::Mul(radius, hn::Set(d, kRoot.first)));
      const W second = hn::Neg(hn::Mul(radius, hn::Set(d, kRoot.second)));
      W third = hn::Mul(radius, hn::Set(d, kRoot.third));
      // This one rounds, by less than 2^-52 of it.
      third = hn::Neg(hn::Add(third, hn::Mul(third, hn::Set(d, 0x1p-51))));
      W value;
      W rest;
      SumExactly(value, rest, x, others..., first, second, third);
      return LowerFloat(value, rest);
    } else {
      const W reach = hn::Mul(radius, hn::Set(d, kRoot.above));
      const W sum = hn::Sub(SumOf(x, others...), reach);
      // Each of up to six roundings is worth 2^-53 of all magnitudes.
      const W magnitude = hn::Add(SumOf(hn::Abs(x), hn::Abs(others)...), reach);
      const W slack = hn::Mul(magnitude, hn::Set(d, 0x1p-50));
      return LowerFloat(hn::Sub(sum, slack), hn::Zero(d));
    }
  }

  template <class W>
  static HWY_INLINE W SumOf(W x) {
    return x;
  }
  template <class W, class... Ws>
  static HWY_INLINE W SumOf(W x, W y, Ws... others) {
    return SumOf(hn::Add(x, y), others...);
  }
};

template <int kDims, Rounding kRounding>
kernels::FitTally FitSpheres(const kernels::FitJob& job) {
  return FitAll(SphereBuilder<kDims, kRounding>(), job,
                job.columns.stride == 1);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_SPHERES_INL_H_
