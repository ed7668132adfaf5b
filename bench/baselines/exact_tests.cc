#include "bench/baselines/exact_tests.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace halfspace::bench {
namespace {

Vector3 Minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

float Dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 Cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

bool IsSeparatedBy(const Vector3& axis, const Triangle& a, const Triangle& b) {
  const Vector3 of_a = {Dot(axis, a[0]), Dot(axis, a[1]), Dot(axis, a[2])};
  const Vector3 of_b = {Dot(axis, b[0]), Dot(axis, b[1]), Dot(axis, b[2])};
  const auto least = [](const Vector3& v) {
    return std::min(std::min(v[0], v[1]), v[2]);
  };
  const auto most = [](const Vector3& v) {
    return std::max(std::max(v[0], v[1]), v[2]);
  };
  return least(of_a) > most(of_b) || most(of_a) < least(of_b);
}

Triangle EdgesOf(const Triangle& t) {
  return {Minus(t[1], t[0]), Minus(t[2], t[1]), Minus(t[0], t[2])};
}

// The radius of a box along an axis.
float Reach(const OrientedBox& box, const Vector3& axis) {
  float reach = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    reach += box.half[k] * std::abs(Dot(box.axes[k], axis));
  }
  return reach;
}

}  // namespace

bool Touch(const Triangle& a, const Triangle& b) {
  const Triangle edges_a = EdgesOf(a);
  const Triangle edges_b = EdgesOf(b);
  const Vector3 normal_a = Cross(edges_a[0], edges_a[1]);
  const Vector3 normal_b = Cross(edges_b[0], edges_b[1]);
  if (IsSeparatedBy(normal_a, a, b) || IsSeparatedBy(normal_b, a, b)) {
    return false;
  }
  for (const Vector3& edge_a : edges_a) {
    for (const Vector3& edge_b : edges_b) {
      if (IsSeparatedBy(Cross(edge_a, edge_b), a, b)) return false;
    }
  }
  // In one plane, all of the above are that plane's normal.
  for (std::size_t k = 0; k < 3; ++k) {
    if (IsSeparatedBy(Cross(normal_a, edges_a[k]), a, b)) return false;
    if (IsSeparatedBy(Cross(normal_b, edges_b[k]), a, b)) return false;
  }
  return true;
}

bool Touch(const Sphere3& a, const Sphere3& b) {
  const Vector3 between = Minus(a.center, b.center);
  const float reach = a.radius + b.radius;
  return Dot(between, between) <= reach * reach;
}

bool Touch(const OrientedBox& a, const OrientedBox& b) {
  const Vector3 between = Minus(b.center, a.center);
  const auto is_separated_by = [&](const Vector3& axis) {
    return std::abs(Dot(between, axis)) > Reach(a, axis) + Reach(b, axis);
  };
  for (const Vector3& axis : a.axes) {
    if (is_separated_by(axis)) return false;
  }
  for (const Vector3& axis : b.axes) {
    if (is_separated_by(axis)) return false;
  }
  for (const Vector3& axis_a : a.axes) {
    for (const Vector3& axis_b : b.axes) {
      if (is_separated_by(Cross(axis_a, axis_b))) return false;
    }
  }
  return true;
}

}  // namespace halfspace::bench
