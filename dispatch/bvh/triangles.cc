// The calls of triangles.h.
#include "halfspace/triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "dispatch/exact/default_fp_mode.h"
#include "dispatch/exact/outward.h"
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
Vector Cross(const Vector& a, const Vector& b) {
  Vector cross;
  for (std::size_t k = 0; k < 3; ++k) {
    cross[k] = a[Next(k)] * b[Last(k)] - a[Last(k)] * b[Next(k)];
  }
  return cross;
}
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
  // Within 2^-52 of the exact sum, which has the same sign.
  double Sum() const { return dispatch::SumExactly(terms_).value; }

 private:
  // Of a product of two floats, which is exact in double.
  void AddProduct(double a, double b) {
    const double product = a * b;
    terms_[count_++] = product;
    terms_[count_++] = std::fma(a, b, -product);
  }

  std::array<double, kCount * 12> terms_{};
  std::size_t count_ = 0;
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

}  // namespace

float HitTriangle(const Ray<3>& ray, const Triangle<3>& triangle) {
  constexpr float kMiss = std::numeric_limits<float>::infinity();
  const dispatch::DefaultFpMode mode;
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

TrianglePoint ClosestPoint(const Point<3>& point, const Triangle<3>& triangle) {
  const dispatch::DefaultFpMode mode;
  const Vector origin = ToDouble(point);
  const std::array<Vector, 3> from = {Minus(ToDouble(triangle.a), origin),
                                      Minus(ToDouble(triangle.b), origin),
                                      Minus(ToDouble(triangle.c), origin)};
  Vector best = from[0];
  const auto consider = [&best](const Vector& other) {
    if (Dot(other, other) < Dot(best, best)) best = other;
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector edge = Minus(from[Next(k)], from[k]);
    const double square = Dot(edge, edge);
    const double part = square > 0.0 ? -Dot(from[k], edge) / square : 0.0;
    const double s = std::clamp(part, 0.0, 1.0);
    consider({from[k][0] + s * edge[0], from[k][1] + s * edge[1],
              from[k][2] + s * edge[2]});
  }
  // The point below, if it is in the triangle, by its weights of the corners.
  const Vector normal = Cross(Minus(from[1], from[0]), Minus(from[2], from[0]));
  Vector weights;
  for (std::size_t k = 0; k < 3; ++k) {
    weights[k] = Dot(normal, Cross(from[Next(k)], from[Last(k)]));
  }
  if (weights[0] > 0.0 && weights[1] > 0.0 && weights[2] > 0.0) {
    const double sum = weights[0] + weights[1] + weights[2];
    Vector inside = {0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        inside[k] += weights[c] / sum * from[c][k];
      }
    }
    consider(inside);
  }
  TrianglePoint result;
  for (std::size_t k = 0; k < 3; ++k) {
    result.point[k] = static_cast<float>(origin[k] + best[k]);
  }
  result.distance = static_cast<float>(std::sqrt(Dot(best, best)));
  return result;
}

}  // namespace halfspace
