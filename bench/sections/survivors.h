// Survivors of one query, for all three shapes.
#ifndef HALFSPACE_BENCH_SECTIONS_SURVIVORS_H_
#define HALFSPACE_BENCH_SECTIONS_SURVIVORS_H_

#include <cstddef>

#include "bench/report/results.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

inline void AddSurvivors(const AaboView3& view, const Aabo3& query,
                         PerShape<std::size_t>& sums) {
  sums.aabb += CountSurvivors(view.aabb(), query.aabb());
  sums.simplex += CountSurvivors(view.simplex(), query.down());
  sums.aabo += CountSurvivors(view, query);
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SURVIVORS_H_
