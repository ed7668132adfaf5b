#include "bench/paper/points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "bench/baselines/bounding_sphere.h"
#include "bench/worlds/moved_clouds.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
NextPoints ScenePoints(std::uint64_t seed) {
  return [clouds = std::make_shared<MovedClouds<3>>(seed)] {
    return clouds->Next();
  };
}

NextPoints BoxPoints(std::uint64_t seed) {
  return [random = Random(seed), points = std::vector<float>(8 * 3)]() mutable {
    constexpr float kHalfOfLongest = 1.75f;
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = kHalfCube * random.Signed();
      const float half = kHalfOfLongest * (random.Signed() + 1) / 2;
      for (std::size_t c = 0; c < 8; ++c) {
        points[3 * c + k] = center + ((c >> k & 1) == 0 ? -half : half);
      }
    }
    return std::span<const float>(points);
  };
}

Aabo3 BoundOnRegularAxes(std::span<const float> points) {
  std::array<double, Aabo3::kAxes> min;
  std::array<double, Aabo3::kAxes> max;
  min.fill(std::numeric_limits<double>::infinity());
  max.fill(-std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const double x = points[i];
    const double y = points[i + 1];
    const double z = points[i + 2];
    const std::array<double, Aabo3::kAxes> along = {x + y + z, x - y - z,
                                                    y - x - z, z - x - y};
    // Two sums round, by half of 2^-52 each.
    const double error = 0x1p-51 * (std::abs(x) + std::abs(y) + std::abs(z));
    for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
      min[k] = std::min(min[k], along[k] - error);
      max[k] = std::max(max[k], along[k] + error);
    }
  }
  Aabo3 bound;
  for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
    bound.min[k] = RoundedDown(min[k]);
    bound.max[k] = -RoundedDown(-max[k]);
  }
  return bound;
}

}  // namespace halfspace::bench
