// Pairs of triangles that touch where only D could tell them apart.
#ifndef HALFSPACE_TESTS_LIBRARY_END_TO_END_TOUCHING_TRIANGLES_H_
#define HALFSPACE_TESTS_LIBRARY_END_TO_END_TOUCHING_TRIANGLES_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>

#include "halfspace/shapes.h"
#include "tests/library/end_to_end/point_beyond.h"
#include "tests/library/support/points.h"

namespace halfspace::testing {

enum class TouchingKind {
  kSharedVertex,  // in another place of the list
  kSharedEdge,    // along which D is constant
  kTJunction,     // a vertex inside such an edge
  kFaceContact,   // a vertex inside a face of constant D
  kRamp,          // two coplanar faces of constant D
};

inline constexpr std::array kTouchingKinds = {
    TouchingKind::kSharedVertex, TouchingKind::kSharedEdge,
    TouchingKind::kTJunction, TouchingKind::kFaceContact, TouchingKind::kRamp};

inline const char* NameOf(TouchingKind kind) {
  constexpr std::array kNames = {"shared vertex", "shared edge", "T-junction",
                                 "face contact", "ramp"};
  return kNames[static_cast<std::size_t>(kind)];
}

// D of `upper` is nowhere below, D of `lower` nowhere above that of the point
// that both have.
struct TouchingTriangles {
  Triangle3 upper;
  Triangle3 lower;
};

// A point and steps away from it along which D is constant: what one coordinate
// gains, another loses. Coordinates are whole multiples of powers of two of
// their own, so that all steps are exact and the sums round more than once.
class Ramp {
 public:
  explicit Ramp(Random& random) : random_(random) {
    std::uniform_int_distribution<int> whole(-(1 << 22), 1 << 22);
    for (std::size_t k = 0; k < 3; ++k) {
      exponents_[k] = RandomExponent(0, 6, random);
      middle_[k] = std::ldexp(static_cast<float>(whole(random)), exponents_[k]);
    }
  }

  const Point3& middle() const { return middle_; }

  Point3 Step() {
    Point3 step{};
    for (std::size_t k : {0, 1}) {
      const float gain = Gain(k, k + 1);
      step[k] += gain;
      step[k + 1] -= gain;
    }
    return step;
  }

  // The middle and `times` steps.
  Point3 At(const Point3& step, float times) const {
    Point3 point = middle_;
    for (std::size_t k = 0; k < 3; ++k) point[k] += times * step[k];
    return point;
  }

 private:
  // A multiple of the unit of both axes.
  float Gain(std::size_t k, std::size_t other) {
    const int fine = std::min(exponents_[k], exponents_[other]);
    const int coarse = std::max(exponents_[k], exponents_[other]);
    std::uniform_int_distribution<int> whole(-(1 << 20), 1 << 20);
    const int units = whole(random_) >> (coarse - fine);
    return std::ldexp(static_cast<float>(units), coarse);
  }

  Random& random_;
  std::array<int, 3> exponents_;
  Point3 middle_;
};

inline TouchingTriangles RandomTouching(TouchingKind kind, Random& random) {
  if (kind == TouchingKind::kSharedVertex) {
    const auto v = RandomPoint<3>(PointKind::kUniform, random);
    const auto beyond = [&](int sign) {
      return PointBeyond(v, sign, 1.f, random);
    };
    return {{v, beyond(1), beyond(1)}, {beyond(-1), beyond(-1), v}};
  }
  Ramp ramp(random);
  const Point3& v = ramp.middle();
  const auto beyond = [&](int sign) {
    return PointBeyond(v, sign, 0x1p20f, random);
  };
  const Point3 step = ramp.Step();
  const Point3 end = ramp.At(step, 1.f);
  const Point3 begin = ramp.At(step, -1.f);
  switch (kind) {
    case TouchingKind::kSharedVertex:
      break;
    case TouchingKind::kSharedEdge:
      return {{end, v, beyond(1)}, {v, beyond(-1), end}};
    case TouchingKind::kTJunction:
      return {{beyond(1), v, beyond(1)}, {begin, end, beyond(-1)}};
    case TouchingKind::kFaceContact: {
      // The middle is the mean of the three.
      const Point3 other = ramp.Step();
      Point3 last = v;
      for (std::size_t k = 0; k < 3; ++k) last[k] -= step[k] + other[k];
      return {{v, beyond(1), beyond(1)}, {end, ramp.At(other, 1.f), last}};
    }
    case TouchingKind::kRamp:
      return {{v, ramp.At(ramp.Step(), 1.f), ramp.At(ramp.Step(), 1.f)},
              {begin, ramp.At(ramp.Step(), 1.f), end}};
  }
  return {};
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_END_TO_END_TOUCHING_TRIANGLES_H_
