// Whether bounds are a pair, by doubles.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_SEPARATED_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_SEPARATED_H_

#include <cmath>
#include <cstddef>
#include <limits>

namespace halfspace::testing {

// Whether x - y is more than a limit. Exact: if the difference rounds to the
// limit, its error decides.
inline bool IsBeyond(double x, double y, double limit) {
  const double difference = x - y;
  if (difference != limit) return difference > limit;
  const double part = difference - x;
  return (x - (difference - part)) - (y + part) > 0;
}

// Whether a plane separates two bounds by more than a margin, which is 2 or 3
// times as large on D. With a margin and `rounding`, the call allows for such a
// share of all values, and for values that grow beyond the greatest float.
template <typename Bound>
bool AreSeparated(const Bound& a, const Bound& b, float margin = 0,
                  double rounding = 0) {
  const auto size = [](float v) {
    return std::isfinite(v) ? std::fabs(static_cast<double>(v)) : 0.0;
  };
  const auto is_beyond = [&](float x, float y, double limit) {
    if (margin == 0 || rounding == 0) return IsBeyond(x, y, limit);
    const double most = size(x) + size(y) + limit;
    const double slack = most * rounding + 0x1p-125;
    constexpr double kMost = std::numeric_limits<float>::max();
    return IsBeyond(x, y, limit + slack) &&
           !(std::isinf(x - y) && most + slack > kMost);
  };
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    const double limit =
        (k < Bound::kDimensions ? 1.0 : Bound::kDimensions) * margin;
    if (is_beyond(a.min[k], b.max[k], limit) ||
        is_beyond(b.min[k], a.max[k], limit)) {
      return true;
    }
  }
  return false;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SEPARATED_H_
