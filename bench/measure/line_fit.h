// The straight line through some points, by least squares.
#ifndef HALFSPACE_BENCH_MEASURE_LINE_FIT_H_
#define HALFSPACE_BENCH_MEASURE_LINE_FIT_H_

#include <cstddef>
#include <span>

namespace halfspace::bench {

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

#endif  // HALFSPACE_BENCH_MEASURE_LINE_FIT_H_
