// Exact sums and outward rounding, in every lane: outward.h for vectors.
//
// Only for translation units compiled without fast-math and contraction, and
// only in the default floating-point mode (default_fp_mode.h).
#if defined(HALFSPACE_KERNELS_EXACT_OUTWARD_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_EXACT_OUTWARD_INL_H_
#undef HALFSPACE_KERNELS_EXACT_OUTWARD_INL_H_
#else
#define HALFSPACE_KERNELS_EXACT_OUTWARD_INL_H_
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

// --- Expansions: parts whose exact sum is the exact sum of what was given,
// after Shewchuk. Parts are passed largest first.

// Adds `carry` to the parts, from the smallest on. Afterwards `carry` is the
// new largest part.
template <class V>
HWY_INLINE void Grow(V& /*carry*/) {}
template <class V, class... Vs>
HWY_INLINE void Grow(V& carry, V& largest, Vs&... smaller) {
  Grow(carry, smaller...);
  TwoSum(carry, largest);
}

// Turns any numbers into parts that do not overlap.
template <class V>
HWY_INLINE void IntoParts(V& /*part*/) {}
template <class V, class... Vs>
HWY_INLINE void IntoParts(V& part, Vs&... others) {
  IntoParts(others...);
  Grow(part, others...);
}

// Sums the parts into the first, which is then less than an ulp from the exact
// sum.
template <class V>
HWY_INLINE void Gather(V& /*part*/) {}
template <class V, class... Vs>
HWY_INLINE void Gather(V& part, V& smaller, Vs&... rest) {
  Gather(smaller, rest...);
  TwoSum(part, smaller);
}

// The largest part that is not zero: it has the sign of all.
template <class V>
HWY_INLINE V Leading(V part) {
  return part;
}
template <class V, class... Vs>
HWY_INLINE V Leading(V part, Vs... smaller) {
  const V zero = hn::Xor(part, part);
  return hn::IfThenElse(hn::Eq(part, zero), Leading(smaller...), part);
}

// The exact sum: `value` is less than an ulp away, and `rest` has the sign of
// the error.
template <class V, class... Vs>
HWY_INLINE void SumExactly(V& value, V& rest, V first, Vs... others) {
  IntoParts(first, others...);
  Gather(first, others...);
  value = first;
  rest = Leading(others...);
}

// --- D

// How D is rounded: within an ulp of the tightest float, or tightest.
enum class Rounding { kWithinUlp, kTightest };

// x + y + ... of one point per lane: afterwards `rest` has the sign of what is
// missing in `sum`. kKnowsRest says whether that is computed at all; without
// it the exact sum is less than an ulp away, on either side.
template <int kDims, Rounding kRounding>
inline constexpr bool kKnowsRest =
    kDims != 3 || kRounding == Rounding::kTightest;

template <Rounding kRounding, class V>
HWY_INLINE void SumOfPoint(V& sum, V& rest, V x, V y) {
  TwoSum(x, y);
  sum = x;
  rest = y;
}

// Four error-free additions, or two error-free ones and two that round.
// docs/exactness.md proves both.
template <Rounding kRounding, class V>
HWY_INLINE void SumOfPoint(V& sum, V& rest, V x, V y, V z) {
  TwoSum(x, y);
  TwoSum(x, z);
  if constexpr (kKnowsRest<3, kRounding>) {
    TwoSum(y, z);
    TwoSum(x, y);
    sum = x;
    rest = hn::Add(y, z);
  } else {
    sum = hn::Add(x, hn::Add(y, z));
  }
}

template <Rounding kRounding, class V>
HWY_INLINE void SumOfPoint(V& sum, V& rest, V x, V y, V z, V w) {
  SumExactly(sum, rest, x, y, z, w);
}

// The largest float not above -(sum + rest), for a point's D.
template <bool kKnown, class D, class V>
HWY_INLINE V LowerD(D d, V sum, V rest) {
  const V negated = hn::Neg(sum);
  if constexpr (kKnown) {
    return hn::IfThenElse(hn::Gt(rest, hn::Zero(d)), NextBelow(d, negated),
                          negated);
  } else {
    (void)rest;
    return NextBelow(d, negated);
  }
}

// The smallest float not below it.
template <bool kKnown, class D, class V>
HWY_INLINE V UpperD(D d, V sum, V rest) {
  return hn::Neg(LowerD<kKnown>(d, hn::Neg(sum), hn::Neg(rest)));
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_EXACT_OUTWARD_INL_H_
