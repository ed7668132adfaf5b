// What is counted and not timed.
#ifndef HALFSPACE_BENCH_MEASURE_COUNTS_H_
#define HALFSPACE_BENCH_MEASURE_COUNTS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "bench/base/shape.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

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
