// A world of one shape that takes half of the first-level cache, and many
// queries against it.
#ifndef HALFSPACE_BENCH_WORLDS_IN_CACHE_H_
#define HALFSPACE_BENCH_WORLDS_IN_CACHE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/base/shape_queries.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/worlds/workload.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

class InCache {
 public:
  InCache(const Workload& workload, const Machine& machine, ShapeKind shape);

  ShapeKind shape() const { return shape_; }
  AaboView3 view() const { return world_.view(); }
  const ShapeQueries& queries() const { return queries_; }
  std::vector<std::uint64_t>& rows() { return rows_; }

  // How often one run of a case asks all queries, and the pairs that makes.
  std::size_t rounds() const { return rounds_; }
  double items() const;

  // The flat kernel by RejectMasks, checked against one query at a time.
  Case MasksCase(std::string name, Target target);

 private:
  ShapeKind shape_;
  AaboWorld3 world_;
  ShapeQueries queries_;
  std::size_t rounds_;
  std::vector<std::uint64_t> rows_;
  std::vector<std::uint64_t> expected_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_IN_CACHE_H_
