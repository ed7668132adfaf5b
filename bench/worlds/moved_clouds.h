// What the paper's scene is made of, in any number of dimensions: point clouds,
// one after the other, each moved to a place of its own.
#ifndef HALFSPACE_BENCH_WORLDS_MOVED_CLOUDS_H_
#define HALFSPACE_BENCH_WORLDS_MOVED_CLOUDS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/worlds/random.h"
#include "bench/worlds/workload.h"
#include "halfspace/fit.h"
#include "halfspace/world.h"

namespace halfspace::bench {

inline constexpr float kHalfCube = kSceneSide / 2;

// 100 clouds of 50 to 64 points uniform in the unit ball.
template <std::size_t kDims>
class MovedClouds {
 public:
  using Cloud = std::vector<std::array<float, kDims>>;

  explicit MovedClouds(std::uint64_t seed) : random_(seed), clouds_(kClouds) {
    for (Cloud& cloud : clouds_) {
      cloud.resize(kFewestPoints +
                   random_.Below(kMostPoints - kFewestPoints + 1));
      for (auto& point : cloud) point = PointInUnitSphere<kDims>(random_);
    }
  }

  // Makes those that follow larger or smaller.
  void Scale(float factor) {
    for (Cloud& cloud : clouds_) {
      for (auto& point : cloud) {
        for (float& coordinate : point) coordinate *= factor;
      }
    }
  }

  // The points of one of the clouds, moved uniformly within [-50, 50]^kDims:
  // their coordinates, point by point. They stay until the next call.
  std::span<const float> Next() {
    const Cloud& cloud = clouds_[random_.Below(kClouds)];
    std::array<float, kDims> to;
    for (float& coordinate : to) coordinate = kHalfCube * random_.Signed();
    std::size_t n = 0;
    for (const auto& point : cloud) {
      for (std::size_t k = 0; k < kDims; ++k) moved_[n++] = point[k] + to[k];
    }
    return std::span(moved_).first(n);
  }
  Aabo<kDims> NextBound() {
    const auto points = Next();
    return BoundPoints(Points<kDims>{points.data(), points.size() / kDims});
  }

 private:
  static constexpr std::size_t kClouds = 100;
  static constexpr std::size_t kFewestPoints = 50;
  static constexpr std::size_t kMostPoints = 64;

  Random random_;
  std::vector<Cloud> clouds_;
  std::array<float, kDims * kMostPoints> moved_;
};

template <int kDims>
struct SceneOf {
  AaboWorld<kDims> objects;
  std::vector<Aabo<kDims>> queries;
};

// Objects, then queries, of clouds with that radius.
template <int kDims>
SceneOf<kDims> MakeSceneOf(std::size_t objects, std::size_t queries,
                           std::uint64_t seed, float radius) {
  MovedClouds<static_cast<std::size_t>(kDims)> clouds(seed);
  clouds.Scale(radius);
  SceneOf<kDims> scene;
  scene.objects.Reserve(objects);
  while (scene.objects.size() < objects) scene.objects.Push(clouds.NextBound());
  while (scene.queries.size() < queries) {
    scene.queries.push_back(clouds.NextBound());
  }
  return scene;
}

// The radius with which as many boxes survive a query as in 3 dimensions. Boxes
// of side s overlap on one axis of the cube with side 100 in 2 s of 100 cases.
// The boxes around clouds of radius 1 have sides of 1.83, 1.72 and 1.63 in 2, 3
// and 4 dimensions, and (2 * 1.72 / 100)^3 is (2 * 0.175 * 1.83 / 100)^2 and
// (2 * 2.46 * 1.63 / 100)^4.
template <int kDims>
inline constexpr float kCloudRadius = kDims == 2   ? 0.175f
                                      : kDims == 3 ? 1.0f
                                                   : 2.46f;

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_MOVED_CLOUDS_H_
