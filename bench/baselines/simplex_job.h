// Plain data alone: it is included where code is compiled above the baseline.
#ifndef HALFSPACE_BENCH_BASELINES_SIMPLEX_JOB_H_
#define HALFSPACE_BENCH_BASELINES_SIMPLEX_JOB_H_

#include <cstddef>

namespace halfspace::bench {

// Planes of simplices, and the queries' values in the same order.
struct SimplexJob {
  const float* planes[4];
  std::size_t objects;
  const float* queries;  // 4 each
  std::size_t query_count;
  std::size_t* counts;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_SIMPLEX_JOB_H_
