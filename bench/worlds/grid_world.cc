#include "bench/worlds/grid_world.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "bench/worlds/grid_scene.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {

std::string GridWorld::WhyNotReached(const Machine& machine,
                                     std::size_t objects) {
  // Floats, quantized bounds with their records, an array of structures, and a
  // bit for each query.
  constexpr std::size_t kBytes = 32 + 8 + 32 + 32 + kQueries / 8 + 1;
  if (machine.is_emulated) {
    return "the scene on a grid takes long and means nothing where the CPU is "
           "emulated";
  }
  if (machine.available_memory != 0 &&
      objects * kBytes > machine.available_memory / 4) {
    return "the scene on a grid needs " +
           std::to_string(objects * kBytes >> 20) +
           " MiB, more than a quarter of what is free";
  }
  return {};
}

GridWorld::GridWorld(std::size_t objects, std::uint64_t seed)
    : GridWorld(MakeGridScene(objects, kQueries, seed)) {}

// The answers of the library's floats; the baselines' own must be equal to
// them.
GridWorld::GridWorld(Workload scene)
    : queries_(scene.queries),
      floats_(std::move(scene.objects)),
      quantized_world_(floats_),
      halves_(MakeHalves(view())) {
  for (ShapeKind shape : kShapes) {
    std::vector<std::size_t>& counts = counts_[static_cast<std::size_t>(shape)];
    counts.resize(queries_.size());
    queries_.With(shape, view(), [&](const auto& view, const auto& queries) {
      SurvivorCounts(view, queries, counts);
    });
  }
}

std::size_t GridWorld::Survivors(ShapeKind shape) const {
  const std::vector<std::size_t>& all = counts(shape);
  return std::accumulate(all.begin(), all.end(), std::size_t{0});
}

std::string GridWorld::Check(ShapeKind shape,
                             const std::vector<std::size_t>& counts) const {
  const std::vector<std::size_t>& expected = this->counts(shape);
  const auto wrong =
      std::mismatch(counts.begin(), counts.end(), expected.begin());
  if (wrong.first == counts.end()) return {};
  return "query " + std::to_string(wrong.first - counts.begin()) + ": " +
         std::to_string(*wrong.first) + " survivors, not " +
         std::to_string(*wrong.second);
}

}  // namespace halfspace::bench
