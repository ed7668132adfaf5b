// The exact test of two triangles that follows a rejection test, as engines
// have it.
#ifndef HALFSPACE_BENCH_BASELINES_TRIANGLES_H_
#define HALFSPACE_BENCH_BASELINES_TRIANGLES_H_

#include <algorithm>
#include <array>
#include <cstddef>

namespace halfspace::bench {

using Vector3 = std::array<float, 3>;
using Triangle = std::array<Vector3, 3>;

inline Vector3 Minus(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline float Dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Vector3 Cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

inline bool IsSeparatedBy(const Vector3& axis, const Triangle& a,
                          const Triangle& b) {
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

inline Triangle EdgesOf(const Triangle& t) {
  return {Minus(t[1], t[0]), Minus(t[2], t[1]), Minus(t[0], t[2])};
}

// True if the triangles have a point in common: by separating axes, in floats.
inline bool Touch(const Triangle& a, const Triangle& b) {
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

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_TRIANGLES_H_
