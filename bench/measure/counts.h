// What is counted and not timed: survivors, and how often whole batches are
// rejected.
#ifndef HALFSPACE_BENCH_MEASURE_COUNTS_H_
#define HALFSPACE_BENCH_MEASURE_COUNTS_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bench/base/shape.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

// How often the first half-space rejects a whole batch of w objects: the
// paper's p^w. p is the share of objects that it rejects. It differs between
// queries.
struct EarlyOut {
  double of_mean_p = 0.0;    // (mean of p)^w, the paper's
  double mean_of_p_w = 0.0;  // mean over queries of p_q^w
  double counted = 0.0;      // share of batches that it rejects whole
};

// With one minimum of each object, and the query's maximum of each query.
// Objects after the last full batch are left out.
inline EarlyOut EarlyOutOf(std::span<const float> minima,
                           std::span<const float> maxima, std::size_t w) {
  const std::size_t batches = minima.size() / w;
  const auto objects = static_cast<double>(batches * w);
  double sum_p = 0.0;
  EarlyOut result;
  for (float maximum : maxima) {
    std::size_t rejected = 0;
    std::size_t whole = 0;
    for (std::size_t b = 0; b < batches; ++b) {
      std::size_t of_batch = 0;
      for (std::size_t i = b * w; i < (b + 1) * w; ++i) {
        of_batch += minima[i] > maximum ? 1 : 0;
      }
      rejected += of_batch;
      whole += of_batch == w ? 1 : 0;
    }
    const double p = static_cast<double>(rejected) / objects;
    sum_p += p;
    result.mean_of_p_w += std::pow(p, static_cast<double>(w));
    result.counted += static_cast<double>(whole) / static_cast<double>(batches);
  }
  const auto queries = static_cast<double>(maxima.size());
  result.of_mean_p = std::pow(sum_p / queries, static_cast<double>(w));
  result.mean_of_p_w /= queries;
  result.counted /= queries;
  return result;
}

// The batches of `width` objects, a power of two up to 64, of whose bits one is
// set; of all batches of whole words.
inline std::size_t BatchesWithSurvivor(std::span<const std::uint64_t> mask,
                                       std::size_t width) {
  const std::uint64_t batch = ~std::uint64_t{0} >> (64 - width);
  std::size_t count = 0;
  for (std::uint64_t word : mask) {
    if (word == 0) continue;
    for (std::size_t l = 0; l < 64; l += width) {
      count += (word >> l & batch) != 0 ? 1 : 0;
    }
  }
  return count;
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
