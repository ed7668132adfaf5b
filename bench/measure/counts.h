// What is counted and not timed: survivors, and how often whole batches are
// rejected.
#ifndef HALFSPACE_BENCH_MEASURE_COUNTS_H_
#define HALFSPACE_BENCH_MEASURE_COUNTS_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/base/shape.h"
#include "bench/measure/measure.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

// The mean of some values, and the range that has the mean of all such values
// with a probability of 95 %: two standard errors on each side.
inline Ratio MeanOf(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (double value : values) mean += value / count;
  double square = 0.0;
  for (double value : values) square += (value - mean) * (value - mean);
  const double error =
      count > 1.0 ? std::sqrt(square / (count - 1.0) / count) : 0.0;
  return {mean, mean - 2.0 * error, mean + 2.0 * error};
}

// How often the first half-space rejects a whole batch of w objects: the
// paper's p^w. p is the share of objects that it rejects. It differs between
// queries.
struct EarlyOut {
  double of_mean_p = 0.0;  // (mean of p)^w, the paper's
  Ratio mean_of_p_w;       // mean over queries of p_q^w
  Ratio counted;           // share of batches that it rejects whole
};

// With one minimum of each object, and the query's maximum of each query.
// Objects after the last full batch are left out.
inline EarlyOut EarlyOutOf(std::span<const float> minima,
                           std::span<const float> maxima, std::size_t w) {
  const std::size_t batches = minima.size() / w;
  std::vector<float> objects(
      minima.begin(),
      minima.begin() + static_cast<std::ptrdiff_t>(batches * w));
  std::vector<float> least;  // of each batch: it is rejected if this one is
  for (auto batch = objects.begin(); batch != objects.end();
       batch += static_cast<std::ptrdiff_t>(w)) {
    least.push_back(
        *std::min_element(batch, batch + static_cast<std::ptrdiff_t>(w)));
  }
  std::sort(objects.begin(), objects.end());
  std::sort(least.begin(), least.end());
  const auto share_above = [](const std::vector<float>& sorted, float maximum) {
    const auto first = std::upper_bound(sorted.begin(), sorted.end(), maximum);
    return static_cast<double>(sorted.end() - first) /
           static_cast<double>(sorted.size());
  };
  std::vector<double> p;
  std::vector<double> powers;
  std::vector<double> counted;
  for (float maximum : maxima) {
    p.push_back(share_above(objects, maximum));
    powers.push_back(std::pow(p.back(), static_cast<double>(w)));
    counted.push_back(share_above(least, maximum));
  }
  return {std::pow(MeanOf(p).median, static_cast<double>(w)), MeanOf(powers),
          MeanOf(counted)};
}

// The batches of 64 objects that have a survivor.
inline std::size_t BatchesWithSurvivor(std::span<const std::uint64_t> mask) {
  return mask.size() -
         static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 0u));
}

// Adds the survivors of one query.
template <typename T>
void AddSurvivors(const AaboView3& view, const Aabo3& query,
                  PerShape<T>& sums) {
  sums.aabb += static_cast<T>(CountSurvivors(view.aabb(), query.aabb()));
  sums.simplex += static_cast<T>(CountSurvivors(view.simplex(), query.down()));
  sums.aabo += static_cast<T>(CountSurvivors(view, query));
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_COUNTS_H_
