// Error-free addition and the next float, in every lane.
//
// Only for translation units compiled without fast-math and contraction, and
// only in the default floating-point mode (default_fp_mode.h).
#if defined(HALFSPACE_KERNELS_FIT_MANY_OUTWARD_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_OUTWARD_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_OUTWARD_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_OUTWARD_INL_H_
#endif

#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Knuth's: afterwards sum + error is the exact sum of both before.
template <class V>
HWY_INLINE void TwoSum(V& sum, V& error) {
  const V a = sum;
  const V b = error;
  sum = hn::Add(a, b);
  const V b_part = hn::Sub(sum, a);
  error = hn::Add(hn::Sub(a, hn::Sub(sum, b_part)), hn::Sub(b, b_part));
}

// The next float below; of either zero, the subnormal below zero.
template <class D, class V>
HWY_INLINE V NextBelow(D d, V x) {
  const hn::RebindToSigned<D> di;
  const auto zero = hn::Zero(d);
  const auto is_positive = hn::Gt(x, zero);
  const V sign = hn::BitCast(d, hn::Set(di, INT32_MIN));
  // Below zero, magnitudes grow: +0 counts as -0 there.
  const auto bits =
      hn::BitCast(di, hn::IfThenElse(is_positive, x, hn::Or(x, sign)));
  const auto step = hn::BitCast(
      di, hn::IfThenElse(is_positive, hn::BitCast(d, hn::Set(di, -1)),
                         hn::BitCast(d, hn::Set(di, 1))));
  return hn::BitCast(d, hn::Add(bits, step));
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_OUTWARD_INL_H_
