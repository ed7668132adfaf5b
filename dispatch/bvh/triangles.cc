// The calls of triangles.h.
#include "dispatch/bvh/triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>

#include "dispatch/default_fp_mode.h"
#include "dispatch/outward.h"
#include "halfspace/shapes.h"

namespace halfspace {
namespace {

using Vector = std::array<double, 3>;

constexpr std::size_t Next(std::size_t k) { return (k + 1) % 3; }
constexpr std::size_t Last(std::size_t k) { return (k + 2) % 3; }

Vector Minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector ToDouble(const Point<3>& a) { return {a[0], a[1], a[2]}; }
double Dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct Approximate {
  double value;
  double error;  // at most

  // Whether the error is less than this part of the value.
  bool IsWithin(double part) const {
    return error == 0.0 || std::fabs(value) * part > error;
  }
};

// The determinant of three columns, each of which is off by 2^-53 of itself.
// Nine roundings, at most. Nothing underflows, because the columns are
// differences of floats.
Approximate Determinant(const Vector& a, const Vector& b, const Vector& c) {
  double value = 0.0;
  double magnitude = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double left = b[Next(k)] * c[Last(k)];
    const double right = b[Last(k)] * c[Next(k)];
    value += a[k] * (left - right);
    magnitude += std::fabs(a[k]) * (std::fabs(left) + std::fabs(right));
  }
  return {value, magnitude * 0x1p-49};
}

// An exact sum, as parts that do not overlap, in the order of their magnitude.
template <std::size_t kMost>
class Expansion {
 public:
  void Add(double value) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const auto [sum, error] = dispatch::TwoSum(value, parts_[i]);
      if (error != 0.0) parts_[count++] = error;
      value = sum;
    }
    if (value != 0.0) parts_[count++] = value;
    count_ = count;
  }
  // Within 2^-52 of the exact sum, which has the same sign.
  double Sum() const {
    return std::accumulate(parts_.begin(),
                           parts_.begin() + static_cast<std::ptrdiff_t>(count_),
                           0.0);
  }
  std::span<const double> parts() const { return {parts_.data(), count_}; }

 private:
  std::array<double, kMost> parts_{};
  std::size_t count_ = 0;
};

// A sum of kCount determinants of floats.
template <std::size_t kCount>
class Determinants {
 public:
  Determinants& Add(double sign, const Point<3>& a, const Point<3>& b,
                    const Point<3>& c) {
    for (std::size_t k = 0; k < 3; ++k) {
      AddProduct(sign * a[k] * b[Next(k)], c[Last(k)]);
      AddProduct(-sign * a[k] * b[Last(k)], c[Next(k)]);
    }
    return *this;
  }
  double Sum() const { return sum_.Sum(); }

 private:
  // a and b are floats, whose product is exact in double.
  void AddProduct(double a, double b) {
    const double product = a * b;
    sum_.Add(std::fma(a, b, -product));
    sum_.Add(product);
  }

  Expansion<kCount * 12> sum_;
};

// The determinant of the direction d, p - o and q - o.
double ExactSide(const Point<3>& d, const Point<3>& o, const Point<3>& p,
                 const Point<3>& q) {
  return Determinants<3>()
      .Add(1, d, p, q)
      .Add(-1, d, o, q)
      .Add(-1, d, p, o)
      .Sum();
}

// The determinant of a - o, b - o and c - o.
double ExactVolume(const Point<3>& o, const Triangle<3>& triangle) {
  const auto& [a, b, c] = triangle;
  return Determinants<4>()
      .Add(1, a, b, c)
      .Add(-1, o, b, c)
      .Add(-1, a, o, c)
      .Add(-1, a, b, o)
      .Sum();
}

// So that t is off by less than a quarter of a float.
constexpr double kPart = 0x1p-28;

// A cross product. Each component is off by less than 2^-51 of its magnitude,
// if the factors are differences of floats, rounded to double.
struct CrossProduct {
  CrossProduct(const Vector& a, const Vector& b) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double left = a[Next(k)] * b[Last(k)];
      const double right = a[Last(k)] * b[Next(k)];
      value[k] = left - right;
      magnitude[k] = std::fabs(left) + std::fabs(right);
    }
  }

  Vector value;
  Vector magnitude;
};

// The cross product of b - a and c - a: the sum of those of a and b, b and c,
// and c and a. Double holds a product of two floats.
using ExactNormal = std::array<Expansion<6>, 3>;
ExactNormal ExactNormalOf(const Point<3>& a, const Point<3>& b,
                          const Point<3>& c) {
  ExactNormal normal;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto add = [&](const Point<3>& p, const Point<3>& q) {
      normal[k].Add(double{p[Next(k)]} * q[Last(k)]);
      normal[k].Add(-double{p[Last(k)]} * q[Next(k)]);
    };
    add(a, b);
    add(b, c);
    add(c, a);
  }
  return normal;
}

// Has the sign of the exact scalar product.
double ExactDot(const ExactNormal& a, const ExactNormal& b) {
  Expansion<3 * 6 * 6 * 2> sum;
  for (std::size_t k = 0; k < 3; ++k) {
    for (const double x : a[k].parts()) {
      for (const double y : b[k].parts()) {
        sum.Add(std::fma(x, y, -(x * y)));
        sum.Add(x * y);
      }
    }
  }
  return sum.Sum();
}

// A triangle and a point. Edge k is opposite to corner k, and goes from corner
// Next(k) to corner Last(k).
class ClosestOnTriangle {
 public:
  ClosestOnTriangle(const Point<3>& point, const Triangle<3>& triangle)
      : point_(point), corners_{&triangle.a, &triangle.b, &triangle.c} {
    for (std::size_t k = 0; k < 3; ++k) {
      from_[k] = Minus(ToDouble(*corners_[k]), ToDouble(point));
      edges_[k] =
          Minus(ToDouble(*corners_[Last(k)]), ToDouble(*corners_[Next(k)]));
      squares_[k] = Dot(edges_[k], edges_[k]);
    }
  }

  // Returns the way from the point to the closest one. The point is beyond an
  // edge if it is not on the triangle's side of the plane through the edge at
  // right angles to the triangle. This is decided exactly, because the planes
  // of a thin triangle are close together far beyond its tip.
  Vector Find() const {
    CrossProduct normal(edges_[1], edges_[2]);
    // So that the normal is off by less than 2^-47 of its length.
    if (SizeOf(normal.value) * 8 < SizeOf(normal.magnitude)) {
      const ExactNormal exact = Normal();
      for (std::size_t k = 0; k < 3; ++k) {
        normal.value[k] = exact[k].Sum();
        normal.magnitude[k] = std::fabs(normal.value[k]);
      }
    }
    if (SizeOf(normal.value) == 0.0) {
      // All on a line.
      const auto longest = std::max_element(squares_.begin(), squares_.end());
      return OnEdge(static_cast<std::size_t>(longest - squares_.begin()));
    }
    std::array<bool, 3> is_beyond;
    for (std::size_t k = 0; k < 3; ++k) is_beyond[k] = Weight(normal, k) < 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = Next(k);
      const std::size_t last = Last(k);
      // If the point is beyond one edge alone, that has the closest point.
      if (is_beyond[k] && !is_beyond[next] && !is_beyond[last]) {
        return OnEdge(k);
      }
      // If it is beyond two, at most one of them goes from their corner towards
      // the point.
      if (is_beyond[next] && is_beyond[last]) {
        const double along_next =
            Dot(from_[k], edges_[next]) / std::sqrt(squares_[next]);
        const double along_last =
            -Dot(from_[k], edges_[last]) / std::sqrt(squares_[last]);
        return OnEdge(along_next > along_last ? next : last);
      }
    }
    const double height =
        Dot(normal.value, from_[0]) / Dot(normal.value, normal.value);
    Vector way;
    for (std::size_t k = 0; k < 3; ++k) way[k] = height * normal.value[k];
    return way;
  }

 private:
  static double SizeOf(const Vector& a) {
    return std::fabs(a[0]) + std::fabs(a[1]) + std::fabs(a[2]);
  }
  ExactNormal Normal() const {
    return ExactNormalOf(*corners_[0], *corners_[1], *corners_[2]);
  }
  double Weight(const CrossProduct& normal, std::size_t k) const {
    const CrossProduct side(from_[Next(k)], edges_[k]);
    const Approximate weight = {
        Dot(normal.value, side.value),
        Dot(normal.magnitude, side.magnitude) * 0x1p-49};
    if (weight.IsWithin(1.0)) return weight.value;
    return ExactDot(Normal(), ExactNormalOf(point_, *corners_[Next(k)],
                                            *corners_[Last(k)]));
  }
  Vector OnEdge(std::size_t k) const {
    const double part =
        squares_[k] > 0.0 ? -Dot(from_[Next(k)], edges_[k]) / squares_[k] : 0.0;
    const double s = std::clamp(part, 0.0, 1.0);
    Vector way = from_[Next(k)];
    for (std::size_t i = 0; i < 3; ++i) way[i] += s * edges_[k][i];
    return way;
  }

  const Point<3>& point_;
  std::array<const Point<3>*, 3> corners_;
  std::array<Vector, 3> from_;  // the point to the corners
  std::array<Vector, 3> edges_;
  std::array<double, 3> squares_;  // of the lengths of edges
};

}  // namespace

float detail::HitOf(const Ray<3>& ray, const Triangle<3>& triangle) {
  constexpr float kMiss = std::numeric_limits<float>::infinity();
  const std::array<const Point<3>*, 3> corners = {&triangle.a, &triangle.b,
                                                  &triangle.c};
  const Vector direction = ToDouble(ray.direction);
  const Vector origin = ToDouble(ray.origin);
  std::array<Vector, 3> from;
  for (std::size_t k = 0; k < 3; ++k) {
    from[k] = Minus(ToDouble(*corners[k]), origin);
  }
  // On which side of each edge the line passes: the volumes of three
  // tetrahedra, whose sum is that of the direction and two edges.
  const auto exact_side = [&](std::size_t k) {
    return ExactSide(ray.direction, ray.origin, *corners[Next(k)],
                     *corners[Last(k)]);
  };
  Approximate sum = {0.0, 0.0};
  bool is_below = false;
  bool is_above = false;
  for (std::size_t k = 0; k < 3; ++k) {
    Approximate side = Determinant(direction, from[Next(k)], from[Last(k)]);
    if (!side.IsWithin(1.0)) side = {exact_side(k), 0.0};
    is_below |= side.value < 0.0;
    is_above |= side.value > 0.0;
    sum.value += side.value;
    sum.error += side.error;
  }
  if (is_below == is_above) return kMiss;
  if (!sum.IsWithin(kPart)) {
    // All have one sign.
    sum.value = exact_side(0) + exact_side(1) + exact_side(2);
  }
  Approximate volume = Determinant(from[0], from[1], from[2]);
  if (!volume.IsWithin(kPart)) {
    volume.value = ExactVolume(ray.origin, triangle);
  }
  const double t = volume.value / sum.value;
  if (!(t >= 0.0) || !std::isfinite(sum.value)) return kMiss;
  const auto rounded = static_cast<float>(std::fabs(t));  // not -0
  return rounded <= ray.max_t ? rounded : kMiss;
}

TrianglePoint detail::ClosestOf(const Point<3>& point,
                                const Triangle<3>& triangle) {
  const Vector way = ClosestOnTriangle(point, triangle).Find();
  TrianglePoint result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.point[k] = static_cast<float>(point[k] + way[k]);
  }
  result.distance = static_cast<float>(std::sqrt(Dot(way, way)));
  return result;
}

float HitTriangle(const Ray<3>& ray, const Triangle<3>& triangle) {
  return dispatch::InDefaultFpMode(
      [&] { return detail::HitOf(ray, triangle); });
}

TrianglePoint ClosestPoint(const Point<3>& point, const Triangle<3>& triangle) {
  return dispatch::InDefaultFpMode(
      [&] { return detail::ClosestOf(point, triangle); });
}

}  // namespace halfspace
