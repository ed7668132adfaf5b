#include "bench/worlds/scene.h"

#include <array>
#include <cstddef>
#include <vector>

#include "bench/worlds/random.h"
#include "bench/worlds/unit_sphere.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kClouds = 100;
constexpr std::size_t kFewestPoints = 50;
constexpr std::size_t kMostPoints = 64;
constexpr float kHalfCube = kSceneSide / 2;

using Cloud = std::vector<std::array<float, 3>>;

std::vector<Cloud> MakeClouds(Random& random, float radius) {
  std::vector<Cloud> clouds(kClouds);
  for (Cloud& cloud : clouds) {
    cloud.resize(kFewestPoints + random.Below(kMostPoints - kFewestPoints + 1));
    for (std::array<float, 3>& point : cloud) {
      point = PointInUnitSphere(random);
      for (float& coordinate : point) coordinate *= radius;
    }
  }
  return clouds;
}

Aabo3 BoundMovedCloud(const Cloud& cloud, Random& random) {
  const std::array<float, 3> to = {kHalfCube * random.Signed(),
                                   kHalfCube * random.Signed(),
                                   kHalfCube * random.Signed()};
  std::array<float, 3 * kMostPoints> moved;
  std::size_t n = 0;
  for (const std::array<float, 3>& point : cloud) {
    for (std::size_t k = 0; k < 3; ++k) moved[n++] = point[k] + to[k];
  }
  return BoundPoints(Points3{moved.data(), cloud.size()});
}

}  // namespace

Workload MakeScene(std::size_t objects, std::size_t queries, std::uint64_t seed,
                   const std::function<void(double)>& progress, float radius) {
  constexpr std::size_t kReport = 1 << 14;
  Random random(seed);
  const std::vector<Cloud> clouds = MakeClouds(random, radius);
  Workload scene{"scene", {}, {}};
  scene.objects.Reserve(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    if (i % kReport == 0) {
      progress(static_cast<double>(i) / static_cast<double>(objects));
    }
    scene.objects.Push(BoundMovedCloud(clouds[random.Below(kClouds)], random));
  }
  for (std::size_t i = 0; i < queries; ++i) {
    scene.queries.push_back(
        BoundMovedCloud(clouds[random.Below(kClouds)], random));
  }
  return scene;
}

}  // namespace halfspace::bench
