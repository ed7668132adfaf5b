// Whether two triangles share a point, in exact arithmetic.
#ifndef HALFSPACE_TESTS_LIBRARY_END_TO_END_EXACT_TRIANGLES_H_
#define HALFSPACE_TESTS_LIBRARY_END_TO_END_EXACT_TRIANGLES_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "halfspace/shapes.h"
#include "tests/library/support/exact.h"

namespace halfspace::testing {

namespace internal {

using Whole3 = std::array<mpz_class, 3>;
using WholeTriangle = std::array<Whole3, 3>;

// In units of the smallest float.
inline WholeTriangle WholeOf(const Triangle3& triangle) {
  const std::array<Point3, 3> corners = {triangle.a, triangle.b, triangle.c};
  WholeTriangle whole;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      whole[i][k] = Exact(corners[i][k]) * (mpz_class(1) << 149);
    }
  }
  return whole;
}

inline Whole3 Minus(const Whole3& a, const Whole3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline Whole3 Cross(const Whole3& a, const Whole3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
          a[0] * b[1] - a[1] * b[0]};
}

inline std::array<Whole3, 3> EdgesOf(const WholeTriangle& t) {
  return {Minus(t[1], t[0]), Minus(t[2], t[1]), Minus(t[0], t[2])};
}

// Whether all of `a` lies strictly on one side of all of `b` along the axis.
inline bool Separates(const Whole3& axis, const WholeTriangle& a,
                      const WholeTriangle& b) {
  const auto range = [&](const WholeTriangle& triangle) {
    std::array<mpz_class, 3> along;
    for (std::size_t i = 0; i < 3; ++i) {
      along[i] = axis[0] * triangle[i][0] + axis[1] * triangle[i][1] +
                 axis[2] * triangle[i][2];
    }
    std::sort(along.begin(), along.end());
    return along;
  };
  const auto of_a = range(a);
  const auto of_b = range(b);
  return of_a[0] > of_b[2] || of_b[0] > of_a[2];
}

}  // namespace internal

// Two convex polygons are apart iff one of finitely many axes separates them:
// their normals, the cross products of their edges, and, if they lie in one
// plane, the normals of the edges in it. Touching is intersecting. Neither
// triangle may be flat.
inline bool Intersect(const Triangle3& one, const Triangle3& other) {
  using internal::Cross;
  const auto a = internal::WholeOf(one);
  const auto b = internal::WholeOf(other);
  const auto a_edges = internal::EdgesOf(a);
  const auto b_edges = internal::EdgesOf(b);
  const auto a_normal = Cross(a_edges[0], a_edges[1]);
  const auto b_normal = Cross(b_edges[0], b_edges[1]);
  std::vector<internal::Whole3> axes = {a_normal, b_normal};
  for (const auto& edge : a_edges) {
    axes.push_back(Cross(a_normal, edge));
    for (const auto& other_edge : b_edges) {
      axes.push_back(Cross(edge, other_edge));
    }
  }
  for (const auto& edge : b_edges) axes.push_back(Cross(b_normal, edge));
  return std::none_of(axes.begin(), axes.end(), [&](const auto& axis) {
    return internal::Separates(axis, a, b);
  });
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_END_TO_END_EXACT_TRIANGLES_H_
