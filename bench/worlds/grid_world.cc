#include "bench/worlds/grid_world.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "bench/worlds/random.h"
#include "halfspace/fit.h"
#include "halfspace/reject_many.h"
#include "halfspace/transform.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kClouds = 100;
constexpr std::size_t kPoints = 50;
constexpr std::size_t kSteps = 10000;
constexpr double kHalfCube = 50.0;

Aabo3 MakeCloud(Random& random) {
  std::array<float, 3 * kPoints> coords;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const std::array<float, 3> point = PointInUnitSphere(random);
    for (std::size_t k = 0; k < 3; ++k) coords[3 * i + k] = point[k];
  }
  return BoundPoints(Points3{coords.data(), kPoints});
}

float OnGrid(Random& random) {
  const auto step = static_cast<double>(random.Below(kSteps));
  return static_cast<float>(2.0 * kHalfCube * step / kSteps - kHalfCube);
}

// 16 KiB of up simplices.
constexpr std::size_t kTile = 1024;

std::size_t CountTile(const HalvesWorld& world, const Aabo3& query,
                      std::size_t begin, std::size_t end) {
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const HalvesWorld::Half& up = world.up[i];
    if (up.x > query.max[0]) continue;
    if (up.y > query.max[1]) continue;
    if (up.z > query.max[2]) continue;
    if (up.d > query.max[3]) continue;
    const HalvesWorld::Half& down = world.down[i];
    if (down.x < query.min[0]) continue;
    if (down.y < query.min[1]) continue;
    if (down.z < query.min[2]) continue;
    if (down.d < query.min[3]) continue;
    ++count;
  }
  return count;
}

}  // namespace

Workload MakeGridScene(std::size_t objects, std::size_t queries,
                       std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabo3> clouds(kClouds);
  for (Aabo3& cloud : clouds) cloud = MakeCloud(random);
  const auto moved = [&] {
    const Aabo3& cloud = clouds[random.Below(kClouds)];
    const std::array<float, 3> to = {OnGrid(random), OnGrid(random),
                                     OnGrid(random)};
    return Translate(cloud, to);
  };
  Workload scene{"grid", {}, {}};
  scene.objects.Reserve(objects);
  for (std::size_t i = 0; i < objects; ++i) scene.objects.Push(moved());
  for (std::size_t i = 0; i < queries; ++i) scene.queries.push_back(moved());
  return scene;
}

HalvesWorld MakeHalves(const AaboView3& view) {
  HalvesWorld world;
  world.up.resize(view.size);
  world.down.resize(view.size);
  for (std::size_t i = 0; i < view.size; ++i) {
    world.up[i] = {view.min[0][i], view.min[1][i], view.min[2][i],
                   view.min[3][i]};
    world.down[i] = {view.max[0][i], view.max[1][i], view.max[2][i],
                     view.max[3][i]};
  }
  return world;
}

void CountScalar(const HalvesWorld& world, std::span<const Aabo3> queries,
                 std::span<std::size_t> counts) {
  std::fill(counts.begin(), counts.end(), std::size_t{0});
  for (std::size_t begin = 0; begin < world.up.size(); begin += kTile) {
    const std::size_t end = std::min(begin + kTile, world.up.size());
    for (std::size_t q = 0; q < queries.size(); ++q) {
      counts[q] += CountTile(world, queries[q], begin, end);
    }
  }
}

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
