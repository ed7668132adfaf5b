// Groups of measurements that are spread over a run: the range that they give a
// value, and how often that range is wrong.
#ifndef HALFSPACE_BENCH_MEASURE_GROUPS_H_
#define HALFSPACE_BENCH_MEASURE_GROUPS_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "bench/measure/measure.h"

namespace halfspace::bench {

inline constexpr std::size_t kGroups = 17;

// How often the range of a ratio of kGroups groups excludes 1 if there is no
// difference: each group is above 1 in half of the cases, and all groups but
// one at most are on one side.
inline constexpr double kFalseWinnerChance =
    2.0 * (1 + kGroups) / (std::size_t{1} << kGroups);

// The median of the groups, and the range between the second least and the
// second greatest; of fewer than 10 groups, between the least and the greatest.
// It covers the median of another run of 17 groups in 99 % of the cases, for
// any distribution: the groups are ranked, and nothing else. The values may be
// 0 or infinite.
inline Ratio GroupRange(std::vector<double> groups) {
  std::sort(groups.begin(), groups.end());
  const std::size_t left_out = groups.size() < 10 ? 0 : 1;
  const std::size_t middle = groups.size() / 2;
  // One of two equal values, as the mean of two infinite ones is no number.
  const double median =
      groups.size() % 2 == 1 || groups[middle - 1] == groups[middle]
          ? groups[middle]
          : (groups[middle - 1] + groups[middle]) / 2.0;
  return {median, groups[left_out], groups[groups.size() - 1 - left_out]};
}

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

#endif  // HALFSPACE_BENCH_MEASURE_GROUPS_H_
