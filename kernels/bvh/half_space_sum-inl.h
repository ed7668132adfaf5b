// Tests one vector of bounds against a half-space. BVHs and flat scans both use
// it, so they find the same objects.
//
// Products and sums are rounded upward, so a sum is never less than the exact
// one, and a bound that touches is never rejected. They are IEEE operations in
// a fixed order, so results are the same on every target. Compares decide about
// NaN, because the minimum or maximum of a NaN differs between targets.
#if defined(HALFSPACE_KERNELS_BVH_HALF_SPACE_SUM_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_HALF_SPACE_SUM_INL_H_
#undef HALFSPACE_KERNELS_BVH_HALF_SPACE_SUM_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_HALF_SPACE_SUM_INL_H_
#endif

#include <cstddef>

#include "hwy/highway.h"
#include "kernels/bvh/shape_query.h"
#include "kernels/compiler.h"
#include "kernels/fp_mode.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// a > b ? a : b, so b if one of them is NaN.
template <class V>
HWY_INLINE V GreaterOf(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
  return hn::Max(a, b);
#else
  return hn::IfThenElse(hn::Gt(a, b), a, b);
#endif
}

// a < b ? a : b, so b if one of them is NaN.
template <class V>
HWY_INLINE V LesserOf(V a, V b) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
  return hn::Min(a, b);
#else
  return hn::IfThenElse(hn::Lt(a, b), a, b);
#endif
}

using UpwardFpMode = kernels::FpMode<kernels::Rounding::kUpward>;

// The float that is next to `value` + `error`, upward, where `error` is what
// the rounding of `value` to a double lost.
inline float Upward(double value, double error) {
  auto rounded = static_cast<float>(value);
  if (rounded < value || (rounded == value && error > 0)) {
    const auto bits = kernels::BitCast<uint32_t>(rounded);
    rounded = kernels::BitCast<float>(rounded < 0 ? bits - 1 : bits + 1);
  }
  return rounded;
}

// result(a, b) of each lane.
template <class D, class V, class Result>
HWY_INLINE V OfLanes(D d, V a, V b, const Result& result) {
  HWY_ALIGN float lanes[2][hn::MaxLanes(D())];
  hn::Store(a, d, lanes[0]);
  hn::Store(b, d, lanes[1]);
  for (size_t i = 0; i < hn::Lanes(d); ++i) {
    lanes[0][i] = result(double{lanes[0][i]}, double{lanes[1][i]});
  }
  return hn::Load(d, lanes[0]);
}

// These need the mode UpwardFpMode.
template <class D, class V>
HWY_INLINE V ProductUp(D d, V a, V b) {
  if constexpr (kernels::kRoundsUpward) {
    (void)d;
    return hn::Mul(a, b);
  } else {
    return OfLanes(d, a, b, [](double x, double y) HWY_ATTR {
      return Upward(x * y, 0.0);
    });
  }
}
template <class D, class V>
HWY_INLINE V SumUp(D d, V a, V b) {
  if constexpr (kernels::kRoundsUpward) {
    (void)d;
    return hn::Add(a, b);
  } else {
    return OfLanes(d, a, b, [](double x, double y) HWY_ATTR {
      const double sum = x + y;
      const double of_y = sum - x;
      return Upward(sum, (x - (sum - of_y)) + (y - of_y));
    });
  }
}

// Negative for bounds behind the half-space, or NaN, with the first terms of
// the test. plane_of(term) is a vector of the plane that a term reads. Only the
// factors of a simplex can differ. Needs the mode UpwardFpMode.
template <bool kIsSimplex, class D, class PlaneOf>
HWY_INLINE hn::Vec<D> HalfSpaceSum(D d, const detail::HalfSpaceTest& test,
                                   size_t terms, const PlaneOf& plane_of) {
  auto sum = hn::Set(d, test.offset);
  for (size_t t = 0; t < terms; ++t) {
    const detail::HalfSpaceTest::Term& term = test.term[t];
    const auto value = plane_of(term);
    auto product = ProductUp(d, value, hn::Set(d, term.more));
    if constexpr (kIsSimplex) {
      product = GreaterOf(product, ProductUp(d, value, hn::Set(d, term.less)));
    }
    sum = SumUp(d, sum, product);
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_HALF_SPACE_SUM_INL_H_
