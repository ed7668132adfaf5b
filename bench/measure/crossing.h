// The sizes at which one of two contenders becomes faster than the other, found
// by measuring more sizes near them.
#ifndef HALFSPACE_BENCH_MEASURE_CROSSING_H_
#define HALFSPACE_BENCH_MEASURE_CROSSING_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace halfspace::bench {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where a ratio is above 1. `from` is 0 if that begins below the least size
// measured, and `to` is infinite if it ends above the greatest one. If no size
// has such a ratio, `from` is infinite and `to` is 0.
struct SizeSpan {
  double from = kInfinity;
  double to = 0.0;

  bool operator==(const SizeSpan&) const = default;
};

// A size that was measured.
struct MeasuredSize {
  double size;
  double ratio;
};

// The size at which the ratio is 1: between `low`, whose ratio is at most 1,
// and `high`, whose ratio is above 1. `high` may be the lesser size. Halves the
// distance of their logarithms until they differ by less than a tenth, then
// takes the straight line between the last two.
template <typename RatioAt>
double CrossingBetween(MeasuredSize low, MeasuredSize high, RatioAt ratio_at) {
  constexpr double kClose = 1.1;
  while (std::max(low.size, high.size) >
         kClose * std::min(low.size, high.size)) {
    const double size = std::sqrt(low.size * high.size);
    const MeasuredSize middle = {size, ratio_at(size)};
    (middle.ratio > 1.0 ? high : low) = middle;
  }
  const double part =
      -std::log(low.ratio) / (std::log(high.ratio) - std::log(low.ratio));
  return low.size * std::pow(high.size / low.size, part);
}

// Where `ratio_at`, a function of the size, is above 1. `sizes` ascend. If that
// is the case in several places, the result is the one with the greatest ratio.
template <typename RatioAt>
SizeSpan FindSpan(std::span<const double> sizes, RatioAt ratio_at) {
  std::vector<MeasuredSize> measured;
  std::size_t best = 0;
  for (double size : sizes) {
    measured.push_back({size, ratio_at(size)});
    if (measured.back().ratio > measured[best].ratio) {
      best = measured.size() - 1;
    }
  }
  if (measured[best].ratio <= 1.0) return {};
  SizeSpan span{0.0, kInfinity};
  for (std::size_t i = best; i-- > 0;) {
    if (measured[i].ratio > 1.0) continue;
    span.from = CrossingBetween(measured[i], measured[i + 1], ratio_at);
    break;
  }
  for (std::size_t i = best + 1; i < measured.size(); ++i) {
    if (measured[i].ratio > 1.0) continue;
    span.to = CrossingBetween(measured[i], measured[i - 1], ratio_at);
    break;
  }
  return span;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_CROSSING_H_
