// Tests one vector of bounds against a half-space. BVHs and flat scans both use
// it, so they find the same objects.
//
// Results are the same on every target. All operations are of IEEE arithmetic,
// in a fixed order. Compares decide about NaN, because the minimum or maximum
// of a NaN differs between targets.
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

// Negative for bounds behind the half-space. plane_of(term) is a vector of the
// plane that a term reads.
template <class D, class PlaneOf>
HWY_INLINE hn::Vec<D> HalfSpaceSum(D d, const detail::HalfSpaceTest& test,
                                   const PlaneOf& plane_of) {
  auto sum = hn::Set(d, test.offset);
  for (size_t t = 0; t < test.terms; ++t) {
    const detail::HalfSpaceTest::Term& term = test.term[t];
    const auto value = plane_of(term);
    sum = hn::Add(sum, GreaterOf(hn::Mul(value, hn::Set(d, term.more)),
                                 hn::Mul(value, hn::Set(d, term.less))));
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_HALF_SPACE_SUM_INL_H_
