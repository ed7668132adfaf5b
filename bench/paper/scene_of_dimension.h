// The paper's scene in any number of dimensions.
#ifndef HALFSPACE_BENCH_PAPER_SCENE_OF_DIMENSION_H_
#define HALFSPACE_BENCH_PAPER_SCENE_OF_DIMENSION_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/worlds/moved_clouds.h"
#include "halfspace/fit.h"
#include "halfspace/world.h"

namespace halfspace::bench {

template <int kDims>
struct SceneOf {
  double scale = 1.0;
  AaboWorld<kDims> objects;
  std::vector<Aabo<kDims>> queries;
};

// The mean length of the sides of the boxes around clouds.
template <std::size_t kDims>
double MeanSideOf(const MovedClouds<kDims>& clouds) {
  double sum = 0.0;
  for (const auto& cloud : clouds.clouds()) {
    for (std::size_t k = 0; k < kDims; ++k) {
      const auto [low, high] = std::minmax_element(
          cloud.begin(), cloud.end(),
          [k](const auto& a, const auto& b) { return a[k] < b[k]; });
      sum += double{(*high)[k]} - double{(*low)[k]};
    }
  }
  return sum / static_cast<double>(clouds.clouds().size() * kDims);
}

// What clouds are scaled by, so that as many boxes survive a query as in 3
// dimensions: boxes of side s overlap on one axis of the cube with side 100 in
// 2 s of 100 cases, and the product over all axes is that of 3 dimensions.
inline double ScaleFor(std::size_t dims, double mean_side,
                       double mean_side_in_3) {
  constexpr double kCube = 2.0 * kHalfCube;
  const double share = std::pow(2.0 * mean_side_in_3 / kCube, 3.0);
  return std::pow(share, 1.0 / static_cast<double>(dims)) * kCube /
         (2.0 * mean_side);
}

// Clouds of 50 to 64 points uniform in the d-ball of radius `scale`, moved
// uniformly within [-50, 50]^kDims. In 3 dimensions, the scene of that seed.
template <int kDims>
SceneOf<kDims> MakeSceneOf(std::size_t objects, std::size_t queries,
                           std::uint64_t seed) {
  constexpr auto kSize = static_cast<std::size_t>(kDims);
  MovedClouds<kSize> clouds(seed);
  SceneOf<kDims> scene;
  if constexpr (kDims != 3) {
    scene.scale =
        ScaleFor(kSize, MeanSideOf(clouds), MeanSideOf(MovedClouds<3>(seed)));
    clouds.Scale(static_cast<float>(scene.scale));
  }
  const auto next = [&clouds] {
    const auto points = clouds.Next();
    return BoundPoints(Points<kDims>{points.data(), points.size() / kSize});
  };
  scene.objects.Reserve(objects);
  for (std::size_t i = 0; i < objects; ++i) scene.objects.Push(next());
  for (std::size_t i = 0; i < queries; ++i) scene.queries.push_back(next());
  return scene;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_SCENE_OF_DIMENSION_H_
