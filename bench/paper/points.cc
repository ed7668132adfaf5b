#include "bench/paper/points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "bench/worlds/moved_clouds.h"
#include "bench/worlds/random.h"

namespace halfspace::bench {
namespace {

// Balls and boxes from one sequence of random numbers.
class Shapes {
 public:
  explicit Shapes(std::uint64_t seed) : random_(seed) {}

  std::span<const float> Ball() {
    constexpr std::size_t kPoints = 50;
    Begin();
    for (std::size_t i = 0; i < kPoints; ++i) {
      const std::array<float, 3> point = PointInUnitSphere(random_);
      for (std::size_t k = 0; k < 3; ++k) Push(k, point[k]);
    }
    return points_;
  }

  std::span<const float> Box() {
    constexpr float kHalfOfLongest = 1.75f;
    Begin();
    std::array<float, 3> half;
    for (float& x : half) x = kHalfOfLongest * (random_.Signed() + 1) / 2;
    for (std::size_t c = 0; c < 8; ++c) {
      for (std::size_t k = 0; k < 3; ++k) {
        Push(k, (c >> k & 1) == 0 ? -half[k] : half[k]);
      }
    }
    return points_;
  }

 private:
  void Begin() {
    points_.clear();
    for (float& x : center_) x = kHalfCube * random_.Signed();
  }
  void Push(std::size_t axis, float x) { points_.push_back(center_[axis] + x); }

  Random random_;
  std::array<float, 3> center_{};
  std::vector<float> points_;
};

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kMostFloat = std::numeric_limits<float>::max();

float RoundedDown(double value) {
  if (value < -kMostFloat) return -kInfinity;
  const auto rounded = static_cast<float>(std::min(value, kMostFloat));
  return rounded > value ? std::nextafter(rounded, -kInfinity) : rounded;
}

}  // namespace

NextPoints ScenePoints(std::uint64_t seed) {
  return [clouds = std::make_shared<MovedClouds<3>>(seed)] {
    return clouds->Next();
  };
}

NextPoints BallPoints(std::uint64_t seed) {
  return [shapes = std::make_shared<Shapes>(seed)] { return shapes->Ball(); };
}

NextPoints BoxPoints(std::uint64_t seed) {
  return [shapes = std::make_shared<Shapes>(seed)] { return shapes->Box(); };
}

NextPoints MixedPoints(std::uint64_t seed) {
  return [shapes = std::make_shared<Shapes>(seed), is_ball = false]() mutable {
    is_ball = !is_ball;
    return is_ball ? shapes->Ball() : shapes->Box();
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
