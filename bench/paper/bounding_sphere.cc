#include "bench/paper/bounding_sphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace halfspace::bench {
namespace {

// What an operation on doubles may be wrong by, several times over.
constexpr double kDoubleSlack = 1.0 + 0x1p-49;

using Center = std::array<double, 3>;

// The point farthest from a center, and the square of its distance.
std::pair<std::size_t, double> FarthestFrom(const Center& center,
                                            std::span<const float> points) {
  std::pair<std::size_t, double> farthest{0, 0.0};
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double along = points[i + k] - center[k];
      square += along * along;
    }
    if (square > farthest.second) farthest = {i, square};
  }
  return farthest;
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
  Center center;
  for (std::size_t k = 0; k < 3; ++k) {
    double min = points[k];
    double max = points[k];
    for (std::size_t i = k; i < points.size(); i += 3) {
      min = std::min<double>(min, points[i]);
      max = std::max<double>(max, points[i]);
    }
    center[k] = 0.5 * min + 0.5 * max;
  }
  const std::size_t steps =
      std::clamp<std::size_t>(6000 / points.size(), 32, 256);
  Center best = center;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t step = 1; step <= steps; ++step) {
    const auto [point, square] = FarthestFrom(center, points);
    if (square < least) {
      least = square;
      best = center;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      center[k] +=
          (points[point + k] - center[k]) / static_cast<double>(step + 1);
    }
  }
  Sphere<3> sphere;
  for (std::size_t k = 0; k < 3; ++k) {
    sphere.center[k] = static_cast<float>(best[k]);
    center[k] = sphere.center[k];
  }
  sphere.radius =
      RoundedUp(std::sqrt(FarthestFrom(center, points).second) * kDoubleSlack);
  return sphere;
}

Sphere<3> Inflated(const Sphere<3>& sphere) {
  return {sphere.center,
          RoundedUp(sphere.radius * (1.0 + 0x1p-20) * kDoubleSlack + 0x1p-60)};
}

}  // namespace halfspace::bench
