// Up to which size one thing is faster than another.
#ifndef HALFSPACE_BENCH_MEASURE_CROSSOVER_SIZE_H_
#define HALFSPACE_BENCH_MEASURE_CROSSOVER_SIZE_H_

#include <cmath>
#include <cstddef>
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

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_CROSSOVER_SIZE_H_
