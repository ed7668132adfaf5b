#include "bench/worlds/bounding_sphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace halfspace::bench {
namespace {

// What an operation on doubles may be wrong by, several times over.
constexpr double kDoubleSlack = 1.0 + 0x1p-49;

struct Farthest {
  std::size_t point = 0;
  double square = 0.0;  // of its distance
};

Farthest FarthestFrom(const std::array<double, 3>& center,
                      std::span<const float> points) {
  Farthest farthest;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = points[i + k] - center[k];
      square += along * along;
    }
    if (square > farthest.square) farthest = {i, square};
  }
  return farthest;
}

// Of the box around them.
std::array<double, 3> MiddleOf(std::span<const float> points) {
  std::array<double, 3> middle;
  for (std::size_t k = 0; k < 3; ++k) {
    double min = points[k];
    double max = points[k];
    for (std::size_t i = k; i < points.size(); i += 3) {
      min = std::min<double>(min, points[i]);
      max = std::max<double>(max, points[i]);
    }
    middle[k] = 0.5 * min + 0.5 * max;
  }
  return middle;
}

// Not below `value`, and infinite if no float is.
float RoundedUp(double value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  if (!(value <= std::numeric_limits<float>::max())) return kInfinity;
  const auto rounded = static_cast<float>(value);
  return rounded < value ? std::nextafter(rounded, kInfinity) : rounded;
}

}  // namespace

Sphere<3> SphereAround(std::span<const float> points) {
  // Badoiu and Clarkson: a step towards the farthest point, shorter each time.
  // It begins at the middle of the box, which is right for boxes.
  const std::size_t steps =
      std::clamp<std::size_t>(6000 / points.size(), 32, 256);
  std::array<double, 3> center = MiddleOf(points);
  std::array<double, 3> best = center;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t step = 1; step <= steps; ++step) {
    const Farthest farthest = FarthestFrom(center, points);
    if (farthest.square < least) {
      least = farthest.square;
      best = center;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      center[k] += (points[farthest.point + k] - center[k]) /
                   static_cast<double>(step + 1);
    }
  }
  Sphere<3> sphere;
  for (std::size_t k = 0; k < 3; ++k) {
    sphere.center[k] = static_cast<float>(best[k]);
    center[k] = sphere.center[k];
  }
  sphere.radius =
      RoundedUp(std::sqrt(FarthestFrom(center, points).square) * kDoubleSlack);
  return sphere;
}

Sphere<3> Inflated(const Sphere<3>& sphere) {
  return {sphere.center,
          RoundedUp(sphere.radius * (1.0 + 0x1p-20) * kDoubleSlack + 0x1p-60)};
}

}  // namespace halfspace::bench
