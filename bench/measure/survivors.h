// Survivors of one query, for all three shapes.
#ifndef HALFSPACE_BENCH_MEASURE_SURVIVORS_H_
#define HALFSPACE_BENCH_MEASURE_SURVIVORS_H_

#include <cstddef>

#include "bench/base/shape.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

template <typename T>
void AddSurvivors(const AaboView3& view, const Aabo3& query,
                  PerShape<T>& sums) {
  sums.aabb += static_cast<T>(CountSurvivors(view.aabb(), query.aabb()));
  sums.simplex += static_cast<T>(CountSurvivors(view.simplex(), query.down()));
  sums.aabo += static_cast<T>(CountSurvivors(view, query));
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_SURVIVORS_H_
