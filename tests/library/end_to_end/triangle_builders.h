// All the ways to bound triangles: other constructors, orders of vertices and
// of coordinates, precisions, and bulk builders on every target. The bounds of
// two that touch may come from any two of them.
#ifndef HALFSPACE_TESTS_LIBRARY_END_TO_END_TRIANGLE_BUILDERS_H_
#define HALFSPACE_TESTS_LIBRARY_END_TO_END_TRIANGLE_BUILDERS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/fit_many.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {

using Triangles = std::span<const Triangle3>;
using Bounds = std::vector<Aabo3>;

struct TriangleBuilder {
  std::string name;
  std::function<Bounds(Triangles)> bound;
};

namespace internal {

template <typename BoundOne>
TriangleBuilder OneByOne(const char* name, BoundOne bound_one) {
  return {name, [bound_one](Triangles triangles) {
            Bounds bounds;
            for (const Triangle3& t : triangles) bounds.push_back(bound_one(t));
            return bounds;
          }};
}

inline Aabo3 OfDoubles(const Triangle3& t) {
  std::array<Point<3, double>, 3> wide;
  std::copy(t.a.begin(), t.a.end(), wide[2].begin());
  std::copy(t.b.begin(), t.b.end(), wide[0].begin());
  std::copy(t.c.begin(), t.c.end(), wide[1].begin());
  return BoundPoints(Points<3, double>{wide[0].data(), 3});
}

// Coordinates in reverse.
inline Aabo3 Mirrored(const Triangle3& t) {
  Triangle3 mirrored = t;
  for (Point3* p : {&mirrored.a, &mirrored.b, &mirrored.c}) {
    std::reverse(p->begin(), p->end());
  }
  Aabo3 bound = BoundTriangle(mirrored);
  std::swap(bound.min[0], bound.min[2]);
  std::swap(bound.max[0], bound.max[2]);
  return bound;
}

inline Bounds InBulk(Triangles triangles, bool as_sets,
                     const FitOptions& options) {
  static_assert(sizeof(Triangle3) == 9 * sizeof(float));
  const std::size_t corners = 3 * triangles.size();
  const Points3 points{triangles.front().a.data(), corners};
  AaboWorld3 world;
  world.Resize(triangles.size());
  if (as_sets) {
    std::vector<std::size_t> ends;
    for (std::size_t end = 3; end <= corners; end += 3) ends.push_back(end);
    BoundPointSets(points, ends, world.planes(), options);
  } else {
    std::vector<std::uint32_t> indices(corners);
    for (std::size_t i = 0; i < corners; ++i) {
      indices[i] = static_cast<std::uint32_t>(corners - 3 - i / 3 * 3 + i % 3);
    }
    std::reverse(indices.begin(), indices.end());
    BoundTriangles(points, indices, world.planes(), options);
  }
  Bounds bounds;
  for (std::size_t i = 0; i < world.size(); ++i) bounds.push_back(world.Get(i));
  return bounds;
}

}  // namespace internal

inline std::vector<TriangleBuilder> TriangleBuilders() {
  using internal::OneByOne;
  std::vector<TriangleBuilder> builders = {
      OneByOne("BoundTriangle",
               [](const Triangle3& t) { return BoundTriangle(t); }),
      OneByOne("BoundTriangle, another vertex first",
               [](const Triangle3& t) {
                 return BoundTriangle(Triangle3{t.c, t.a, t.b});
               }),
      OneByOne("BoundTriangle, coordinates reversed", internal::Mirrored),
      OneByOne("BoundPoints of doubles", internal::OfDoubles),
      OneByOne("Merge of points",
               [](const Triangle3& t) {
                 return Merge(BoundPoint<3>(t.b),
                              Merge(BoundPoint<3>(t.c), BoundPoint<3>(t.a)));
               }),
      OneByOne("Merge of segments",
               [](const Triangle3& t) {
                 return Merge(BoundSegment(Segment3{t.a, t.c}),
                              BoundSegment(Segment3{t.c, t.b}));
               }),
      OneByOne("BoundTransformed by nothing",
               [](const Triangle3& t) {
                 const Affine3 same{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}};
                 return BoundTransformed(Points3{t.a.data(), 3}, same);
               }),
      OneByOne("BoundAabb of the box", [](const Triangle3& t) {
        return BoundAabb(BoundTriangle(t).aabb());
      })};
  for (Target target : TargetsUnderTest()) {
    for (bool as_sets : {false, true}) {
      for (bool tightest : {false, true}) {
        const FitOptions options{.tightest = tightest, .target = target};
        builders.push_back(
            {std::string(as_sets ? "BoundPointSets" : "BoundTriangles") +
                 (tightest ? ", tightest, " : ", ") +
                 std::string(target.name()),
             [as_sets, options](Triangles triangles) {
               return internal::InBulk(triangles, as_sets, options);
             }});
      }
    }
  }
  return builders;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_END_TO_END_TRIANGLE_BUILDERS_H_
