// The scene of the public aabo benchmark, so many copies of 100 clouds of 50
// points on a grid, in every form that is measured: floats, quantized bounds
// and an array of structures, with the right answers; and the scalar loop that
// one would write instead of calling the library.
#ifndef HALFSPACE_BENCH_WORLDS_GRID_WORLD_H_
#define HALFSPACE_BENCH_WORLDS_GRID_WORLD_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/base/shape.h"
#include "bench/measure/machine.h"
#include "bench/worlds/workload.h"
#include "halfspace/quantized.h"

namespace halfspace::bench {

// 100 clouds of 50 points, uniform in the unit sphere. Each object is a cloud
// that has been moved to a place in [-50, 50]^3, uniform on a grid of 10 000
// steps per axis; queries likewise.
Workload MakeGridScene(std::size_t objects, std::size_t queries,
                       std::uint64_t seed);

// Octahedra as an array of structures, in halves of 16 bytes: all up simplices,
// then all down simplices, so that an object that the first rejects costs 16
// bytes.
struct HalvesWorld {
  struct Half {
    float x, y, z, d;
  };
  std::vector<Half> up;    // minima
  std::vector<Half> down;  // maxima
};

HalvesWorld MakeHalves(const AaboView3& view);

// Counts the survivors of each query, object by object, with an early-out after
// every compare; a tile of objects that stays in the cache for all queries.
void CountScalar(const HalvesWorld& world, std::span<const Aabo3> queries,
                 std::span<std::size_t> counts);

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
