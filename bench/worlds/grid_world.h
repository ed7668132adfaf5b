// The scene on a grid in every form that is measured: floats, quantized bounds
// and an array of structures, with the right answers.
#ifndef HALFSPACE_BENCH_WORLDS_GRID_WORLD_H_
#define HALFSPACE_BENCH_WORLDS_GRID_WORLD_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/base/shape_queries.h"
#include "bench/baselines/baselines.h"
#include "bench/measure/machine.h"
#include "bench/worlds/workload.h"
#include "halfspace/quantized.h"

namespace halfspace::bench {

class GridWorld {
 public:
  static constexpr std::size_t kObjects = 10000000;
  static constexpr std::size_t kQuickObjects = 1000000;
  static constexpr std::size_t kQueries = 100;

  // Empty if it can be made here, else why not.
  static std::string WhyNotReached(const Machine& machine, std::size_t objects);

  GridWorld(std::size_t objects, std::uint64_t seed);

  std::size_t objects() const { return quantized_world_.size(); }
  AaboView3 view() const { return floats_.view(); }
  const QuantizedWorld<AaboView3>& quantized_world() const {
    return quantized_world_;
  }
  const HalvesWorld& halves() const { return halves_; }
  const ShapeQueries& queries() const { return queries_; }

  // Survivors of each query, and in all.
  const std::vector<std::size_t>& counts(ShapeKind shape) const {
    return counts_[static_cast<std::size_t>(shape)];
  }
  std::size_t Survivors(ShapeKind shape) const;

  // Empty if these are the survivors of the first queries, else what is wrong.
  std::string Check(ShapeKind shape,
                    const std::vector<std::size_t>& counts) const;

 private:
  explicit GridWorld(Workload scene);

  ShapeQueries queries_;
  AaboWorld3 floats_;
  QuantizedWorld<AaboView3> quantized_world_;
  HalvesWorld halves_;
  std::array<std::vector<std::size_t>, kShapes.size()> counts_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_GRID_WORLD_H_
