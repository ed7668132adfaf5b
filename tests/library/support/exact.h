// Exact numbers, by GMP, and the floats that bound them.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_EXACT_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_EXACT_H_

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace halfspace::testing {

// The exact value of a finite float or double.
inline mpq_class Exact(double value) { return mpq_class(value); }

// The sign of rational + root * sqrt(n), without irrational numbers: of two
// terms that pull apart, the one with the greater square wins.
inline int SignOf(const mpq_class& rational, const mpq_class& root, int n) {
  const int pull = sgn(rational);
  const int root_pull = sgn(root);
  if (root_pull == 0 || pull == root_pull) return pull;
  if (pull == 0) return root_pull;
  const mpq_class excess = rational * rational - n * root * root;
  return pull * sgn(excess);
}

// rational + root * sqrt(n): whatever a projection of a shape can be.
struct ExactValue {
  // NOLINTNEXTLINE(google-explicit-constructor): a rational number is one.
  ExactValue(mpq_class value) : rational(std::move(value)) {}
  ExactValue(mpq_class value, mpq_class times_root, int root_of)
      : rational(std::move(value)), root(std::move(times_root)), n(root_of) {}

  ExactValue operator-() const { return {-rational, -root, n}; }

  mpq_class rational;
  mpq_class root = 0;
  int n = 1;
};

// The sign of a - b, which have the same n.
inline int Compare(const ExactValue& a, const ExactValue& b) {
  return SignOf(a.rational - b.rational, a.root - b.root, b.n);
}

inline constexpr int kAnyFloats = -1;  // as `loose`: however many

// `bound` is not above `exact`, and at most `loose` floats below the largest
// one that is not above `exact` - `slack`: 0 and 0 ask for the tightest.
inline ::testing::AssertionResult IsBelow(float bound, const ExactValue& exact,
                                          int loose, double slack = 0.0) {
  if (!std::isfinite(bound)) {
    return ::testing::AssertionFailure() << bound << " is not finite";
  }
  const auto is_above = [&](float value, double by) {
    return Compare({Exact(value) + Exact(by), 0, exact.n}, exact) > 0;
  };
  if (is_above(bound, 0.0)) {
    return ::testing::AssertionFailure()
           << std::hexfloat << bound << " is above the exact value, about "
           << exact.rational.get_d() << " + " << exact.root.get_d()
           << " * sqrt(" << exact.n << ")";
  }
  if (loose == kAnyFloats) return ::testing::AssertionSuccess();
  float inwards = bound;
  for (int i = 0; i <= loose; ++i) {
    inwards = std::nextafter(inwards, std::numeric_limits<float>::infinity());
  }
  if (is_above(inwards, slack)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << std::hexfloat << inwards << " is a bound as well, tighter than "
         << bound;
}

// The same the other way round: `bound` is not below `exact`.
inline ::testing::AssertionResult IsAbove(float bound, const ExactValue& exact,
                                          int loose, double slack = 0.0) {
  return IsBelow(-bound, -exact, loose, slack) << " (everything negated)";
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_EXACT_H_
