// Queries one after the other, of which only so many are different.
#ifndef HALFSPACE_BENCH_MEASURE_QUERIES_IN_TURN_H_
#define HALFSPACE_BENCH_MEASURE_QUERIES_IN_TURN_H_

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"

namespace halfspace::bench {

// A case that calls call(query) `per_run` times a run, for queries 0, 1, ... up
// to `different`, and again. It is timed per call; `queries` must outlive it.
template <typename Query, typename Call>
Case InTurn(std::string name, const std::vector<Query>& queries,
            std::size_t different, std::size_t per_run, Call call) {
  Case c;
  c.name = std::move(name) + "/" + std::to_string(different);
  c.items = static_cast<double>(per_run);
  c.run = [&queries, most = std::min(different, queries.size()), per_run, call,
           next = std::size_t{0}]() mutable {
    for (std::size_t i = 0; i < per_run; ++i) {
      call(queries[next]);
      next = next + 1 == most ? 0 : next + 1;
    }
  };
  return c;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_QUERIES_IN_TURN_H_
