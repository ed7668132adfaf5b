// Cases and rows of the scene on a grid.
#ifndef HALFSPACE_BENCH_SECTIONS_GRID_CASES_H_
#define HALFSPACE_BENCH_SECTIONS_GRID_CASES_H_

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/grid_world.h"

namespace halfspace::bench {

// A case of run(counts) that leaves the survivors of the first queries in
// counts, and is checked by them.
template <typename Run>
Case CountsCase(std::string name, const GridWorld& grid, ShapeKind shape,
                std::size_t queries, const Run& run) {
  auto counts = std::make_shared<std::vector<std::size_t>>(queries);
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(grid.objects()) * static_cast<double>(queries);
  c.run = [counts, run] { run(*counts); };
  c.check = [counts, run, &grid, shape] {
    run(*counts);
    return grid.Check(shape, *counts);
  };
  return c;
}

// `target` is empty for what is none of the library's.
inline ThroughputRow GridRow(const GridWorld& grid, std::string name,
                             std::string target, std::size_t queries,
                             const Timing& timing) {
  ThroughputRow row;
  row.name = std::move(name);
  row.objects = grid.objects();
  row.queries = queries;
  row.working_set = "grid";
  row.target = std::move(target);
  row.ns_per_pair = timing.Median();
  return row;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_GRID_CASES_H_
