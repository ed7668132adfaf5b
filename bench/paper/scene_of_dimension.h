// The paper's scene in any number of dimensions.
#ifndef HALFSPACE_BENCH_PAPER_SCENE_OF_DIMENSION_H_
#define HALFSPACE_BENCH_PAPER_SCENE_OF_DIMENSION_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/worlds/moved_clouds.h"
#include "halfspace/world.h"

namespace halfspace::bench {

template <int kDims>
struct SceneOf {
  AaboWorld<kDims> objects;
  std::vector<Aabo<kDims>> queries;
};

// The radius of clouds with which as many boxes survive a query as in 3
// dimensions. Boxes of side s overlap on one axis of the cube with side 100 in
// 2 s of 100 cases. The boxes around clouds of radius 1 have sides
// of 1.83, 1.72 and 1.63 in 2, 3 and 4 dimensions, and (2 * 1.72 / 100)^3 is (2
// * 0.175 * 1.83 / 100)^2 and (2 * 2.46 * 1.63 / 100)^4.
template <int kDims>
inline constexpr float kCloudRadius = kDims == 2   ? 0.175f
                                      : kDims == 3 ? 1.0f
                                                   : 2.46f;

// Clouds of 50 to 64 points uniform in a ball, moved uniformly within
// [-50, 50]^kDims. In 3 dimensions, the scene of that seed.
template <int kDims>
SceneOf<kDims> MakeSceneOf(std::size_t objects, std::size_t queries,
                           std::uint64_t seed) {
  MovedClouds<static_cast<std::size_t>(kDims)> clouds(seed);
  clouds.Scale(kCloudRadius<kDims>);
  SceneOf<kDims> scene;
  scene.objects.Reserve(objects);
  while (scene.objects.size() < objects) scene.objects.Push(clouds.NextBound());
  while (scene.queries.size() < queries) {
    scene.queries.push_back(clouds.NextBound());
  }
  return scene;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_SCENE_OF_DIMENSION_H_
