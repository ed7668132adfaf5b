// Lines through measured points.
#ifndef HALFSPACE_BENCH_MEASURE_CURVES_H_
#define HALFSPACE_BENCH_MEASURE_CURVES_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace halfspace::bench {

// The size from which on `ours` takes longer than `theirs`, with times at
// ascending sizes: where the straight lines between their logarithms cross. 0
// if ours is slower at the first size; the last one if it is never slower.
inline double CrossoverSize(std::span<const double> sizes,
                            std::span<const double> ours,
                            std::span<const double> theirs) {
  double before = 0.0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    // Above 0 where ours is slower.
    const double lag = std::log(ours[i] / theirs[i]);
    if (lag > 0.0) {
      if (i == 0) return 0.0;
      const double part = before / (before - lag);
      return sizes[i - 1] * std::pow(sizes[i] / sizes[i - 1], part);
    }
    before = lag;
  }
  return sizes.back();
}

// What a structure costs.
struct StructureCost {
  double make;   // once
  double query;  // each
};

// The number of queries from which on `one` takes less time in total than
// `other`: at least 1, infinite if it never does. `one` takes longer to make.
inline double PaysFrom(const StructureCost& one, const StructureCost& other) {
  const double more = one.make - other.make;
  const double saved = other.query - one.query;
  if (saved <= 0.0) return std::numeric_limits<double>::infinity();
  return std::max(1.0, more / saved);
}

// The straight line through some points, by least squares.
struct Line {
  double intercept = 0.0;
  double slope = 0.0;
};

// As many y as x, at least two different x.
inline Line FitLine(std::span<const double> x, std::span<const double> y) {
  const auto count = static_cast<double>(x.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / count;
    mean_y += y[i] / count;
  }
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  const double slope = xy / xx;
  return {mean_y - slope * mean_x, slope};
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_CURVES_H_
