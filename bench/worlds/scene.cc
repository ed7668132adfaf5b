#include "bench/worlds/scene.h"

#include <cstddef>

#include "bench/worlds/moved_clouds.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

Aabo3 BoundNext(MovedClouds<3>& clouds) {
  const auto points = clouds.Next();
  return BoundPoints(Points3{points.data(), points.size() / 3});
}

}  // namespace

Workload MakeScene(std::size_t objects, std::size_t queries, std::uint64_t seed,
                   float radius) {
  MovedClouds<3> clouds(seed);
  clouds.Scale(radius);
  Workload scene{"scene", {}, {}};
  scene.objects.Reserve(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    scene.objects.Push(BoundNext(clouds));
  }
  for (std::size_t i = 0; i < queries; ++i) {
    scene.queries.push_back(BoundNext(clouds));
  }
  return scene;
}

Workload SceneOfSize(double share, std::size_t objects, std::uint64_t seed,
                     std::size_t queries) {
  Workload scene = MakeScene(objects, queries, seed,
                             static_cast<float>(share) * kSceneSide / 2);
  scene.timed_queries = scene.queries;
  return scene;
}

}  // namespace halfspace::bench
