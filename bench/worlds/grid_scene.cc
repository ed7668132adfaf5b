#include "bench/worlds/grid_scene.h"

#include <array>
#include <vector>

#include "bench/worlds/random.h"
#include "bench/worlds/unit_sphere.h"
#include "halfspace/fit.h"
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

}  // namespace halfspace::bench
