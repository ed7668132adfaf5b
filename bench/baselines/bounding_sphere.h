// Bounding spheres, which bounds of planes are compared with: the sphere of
// some points, and the exact test of two.
#ifndef HALFSPACE_BENCH_BASELINES_BOUNDING_SPHERE_H_
#define HALFSPACE_BENCH_BASELINES_BOUNDING_SPHERE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "halfspace/shapes.h"

namespace halfspace::bench {

// Not above `value`: -infinity if no float is.
inline float RoundedDown(double value) {
  constexpr float kLeast = -std::numeric_limits<float>::infinity();
  constexpr double kMostFloat = std::numeric_limits<float>::max();
  if (value < -kMostFloat) return kLeast;
  const auto rounded = static_cast<float>(std::min(value, kMostFloat));
  return rounded > value ? std::nextafter(rounded, kLeast) : rounded;
}

inline double SquareBetween(const auto& a, const auto& b) {
  double square = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = double{a[k]} - double{b[k]};
    square += along * along;
  }
  return square;
}

// Whether two spheres touch, whose radii are as many times as long.
inline bool IsWithinReach(const Sphere<3>& a, const Sphere<3>& b,
                          double factor) {
  const double reach = factor * (double{a.radius} + double{b.radius});
  return SquareBetween(a.center, b.center) <= reach * reach;
}

// What an operation on doubles may be wrong by, several times over.
inline constexpr double kDoubleSlack = 1.0 + 0x1p-49;

using Middle = std::array<double, 3>;

// The point farthest from a center, and the square of its distance.
inline std::pair<std::size_t, double> FarthestFrom(
    const Middle& center, std::span<const float> points) {
  std::pair<std::size_t, double> farthest{0, 0.0};
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const double square = SquareBetween(points.subspan(i, 3), center);
    if (square > farthest.second) farthest = {i, square};
  }
  return farthest;
}

// A sphere around points, x y z each, at least one. It is at most a
// few percent larger than the smallest one, and for a segment or a box as small
// as it: the radius encloses the points, rounded up.
inline Sphere<3> SphereAround(std::span<const float> points) {
  // Badoiu and Clarkson: a step towards the farthest point, shorter each time.
  // It begins at the middle of the box, which is right for boxes.
  Middle center;
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
  Middle best = center;
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
  sphere.radius = -RoundedDown(-std::sqrt(FarthestFrom(center, points).second) *
                               kDoubleSlack);
  return sphere;
}

// The sphere, for a test that rounds and must never reject spheres that touch:
// the radius is larger by 2^-20 of it and by 2^-60.
//
// A test compares float sums: d2, of the squares of the differences of the
// centers, with s2, the square of the sum of the radii. Each operation has a
// relative error of at most u = 2^-24, and of a difference that is relative to
// the difference itself: d2 <= |c - q|^2 (1 + u)^5, s2 >= (r + R)^2 (1 - u)^3.
// Where the spheres touch, |c - q| <= r + R; so d2 <= s2 if both radii are
// larger by 5 u of it, and 2^-20 is 16 u. 2^-60 keeps s2 so large that what
// underflows does not count; and what overflows, to infinity on both sides, is
// kept.
inline Sphere<3> Inflated(const Sphere<3>& sphere) {
  return {
      sphere.center,
      -RoundedDown(-sphere.radius * (1.0 + 0x1p-20) * kDoubleSlack - 0x1p-60)};
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BOUNDING_SPHERE_H_
