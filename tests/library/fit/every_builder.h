// The bounds of one sample of every shape by every builder, as bits: for what
// must not change any of them, such as the caller's floating-point mode and
// compiler flags.
//
// The functions are static so that every translation unit has its own, compiled
// with its own flags. They do no arithmetic: only the library does.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_EVERY_BUILDER_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_EVERY_BUILDER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "halfspace/halfspace.h"

namespace halfspace::testing {

template <int kDims>
struct EveryShape {
  static constexpr std::size_t kMany = 70;  // a tile and a tail

  std::array<Point<kDims>, 3> points;
  std::array<Point<kDims, double>, 2> wide_points;
  Ray<kDims> ray;
  Aabb<kDims> box;
  Box<kDims, double> wide_box;
  OrientedBox<kDims> oriented_box;
  Sphere<kDims> sphere;
  Sphere<kDims, double> wide_sphere;
  Capsule<kDims> capsule;
  Affine<kDims> map;
  std::array<HalfSpace3, 6> planes;
  Ray<kDims, double> wide_ray;
  OrientedBox<kDims, double> wide_oriented_box;
  Capsule<kDims, double> wide_capsule;
  Affine<kDims, double> wide_map;
  std::array<HalfSpace<3, double>, 6> wide_planes;
  Aabo<kDims> bound;
  UpSimplex<kDims> simplex;  // contains a point
  Point<kDims> move;
  float length;
  float factor;
  // For the bulk builders.
  std::array<Aabb<kDims>, kMany> boxes;
  std::array<Sphere<kDims>, kMany> spheres;
  std::array<Point<kDims>, kMany> vertices;
  std::array<std::uint32_t, 3 * kMany> indices;
  std::array<std::size_t, kMany> ends;
};

using Bits = std::vector<std::uint32_t>;

template <typename Bound>
static void AppendBits(const Bound& bound, Bits& bits) {
  std::array<std::uint32_t, sizeof(Bound) / 4> words;
  std::memcpy(words.data(), &bound, sizeof(Bound));
  bits.insert(bits.end(), words.begin(), words.end());
}

// Each of these gives every call in turn to visit(call); call() returns what
// the library made.
template <int kDims, typename Visit>
static void VisitFits(const EveryShape<kDims>& s, const Visit& visit) {
  const Points<kDims> points{s.points[0].data(), s.points.size()};
  const Points<kDims, double> wide{s.wide_points[0].data(),
                                   s.wide_points.size()};
  const std::array<std::uint32_t, 2> last = {2, 1};
  const Segment<kDims> segment{s.points[0], s.points[1]};
  PointsSoa<kDims> soa{.coords = {}, .count = 2};
  PointsSoa<kDims, double> wide_soa{.coords = {}, .count = 2};
  soa.coords.fill(s.points[0].data());
  wide_soa.coords.fill(s.wide_points[0].data());
  visit([&] { return BoundPoints(points); });
  visit([&] { return BoundPoints(wide); });
  visit([&] { return BoundPoints(soa); });
  visit([&] { return BoundPoints(wide_soa); });
  visit([&] { return BoundPoints<kDims>(points, last); });
  visit([&] { return BoundPoint<kDims>(s.points[0]); });
  visit([&] { return BoundSegment(segment); });
  visit([&] {
    return BoundTriangle<kDims>({s.points[0], s.points[1], s.points[2]});
  });
  visit([&] { return BoundRay(s.ray); });
  visit([&] {
    std::array<Aabo<kDims>, 3> pieces;
    BoundSegmentPieces(segment, pieces);
    return pieces;
  });
  visit([&] { return BoundAabb(s.box); });
  visit([&] { return BoundAabb(s.wide_box); });
  visit([&] { return BoundOrientedBox(s.oriented_box); });
  visit([&] { return BoundSphere(s.sphere); });
  visit([&] { return BoundSphere(s.wide_sphere); });
  visit([&] { return BoundCapsule(s.capsule); });
  visit([&] { return BoundFrustum(s.planes); });
  visit([&] { return BoundTransformed(points, s.map); });
  visit([&] { return BoundTransformed(s.box, s.map); });
  const Segment<kDims, double> wide_segment{s.wide_points[0], s.wide_points[1]};
  visit([&] { return BoundPoints(wide, std::span(last).subspan(1)); });
  visit([&] { return BoundSegment(wide_segment); });
  visit([&] {
    return BoundTriangle<kDims, double>(
        {s.wide_points[0], s.wide_points[1], s.wide_points[0]});
  });
  visit([&] { return BoundRay(s.wide_ray); });
  visit([&] {
    std::array<Aabo<kDims>, 3> pieces;
    BoundSegmentPieces(wide_segment, pieces);
    return pieces;
  });
  visit([&] { return BoundOrientedBox(s.wide_oriented_box); });
  visit([&] { return BoundCapsule(s.wide_capsule); });
  visit([&] { return BoundFrustum(s.wide_planes); });
  visit([&] { return BoundTransformed(points, s.wide_map); });
  visit([&] { return BoundTransformed(s.wide_box, s.wide_map); });
}

template <int kDims, typename Visit>
static void VisitTransforms(const EveryShape<kDims>& s, const Visit& visit) {
  const auto visit_all = [&](const auto& bound) {
    visit([&] { return Merge(bound, bound); });
    visit([&] { return Inflate(bound, s.length); });
    visit([&] { return InflateByBox(bound, s.length); });
    visit([&] { return Translate(bound, s.move); });
    visit([&] { return Scale(bound, s.length); });
    visit([&] { return Sweep(bound, s.move); });
  };
  visit_all(s.bound);
  visit_all(s.bound.up());
  visit_all(s.bound.down());
  visit_all(s.bound.aabb());
  visit([&] { return TranslateVertices(s.bound, s.move); });
  visit([&] { return TranslateVertices(s.bound.aabb(), s.move); });
  visit([&] { return Scale(s.bound, s.factor); });
  visit([&] { return Scale(s.bound.aabb(), s.factor); });
  visit([&] { return Circumscribe(s.simplex); });
  visit([&] { return Circumscribe(Circumscribe(s.simplex)); });
}

template <int kDims, typename Visit>
static void VisitBulk(const EveryShape<kDims>& s, const FitOptions& options,
                      const Visit& visit) {
  constexpr std::size_t kMany = EveryShape<kDims>::kMany;
  const auto visit_one = [&](auto build) {
    visit([&] {
      std::array<std::array<float, kMany>, 2 * (kDims + 1)> memory;
      AaboPlanes<kDims> planes{.min = {}, .max = {}, .size = kMany};
      for (std::size_t k = 0; k <= kDims; ++k) {
        planes.min[k] = memory[2 * k].data();
        planes.max[k] = memory[2 * k + 1].data();
      }
      build(planes);
      return memory;
    });
  };
  Spheres<kDims> spheres{.radius = &s.spheres[0].radius,
                         .count = s.spheres.size(),
                         .stride = sizeof(Sphere<kDims>) / sizeof(float)};
  for (std::size_t k = 0; k < kDims; ++k) {
    spheres.center[k] = s.spheres[0].center.data() + k;
  }
  const Points<kDims> vertices{s.vertices[0].data(), s.vertices.size()};
  visit_one([&](const auto& planes) {
    BoundBoxes(BoxesOf<kDims>(s.boxes), planes, options);
  });
  visit_one(
      [&](const auto& planes) { BoundSpheres(spheres, planes, options); });
  visit_one([&](const auto& planes) {
    BoundTriangles(vertices, s.indices, planes, options);
  });
  visit_one([&](const auto& planes) {
    BoundPointSets(vertices, s.ends, planes, options);
  });
}

// The bulk builders on the given targets.
template <int kDims, typename Visit>
static void VisitEveryBuilder(const EveryShape<kDims>& shape,
                              const std::vector<Target>& targets,
                              const Visit& visit) {
  VisitFits(shape, visit);
  VisitTransforms(shape, visit);
  for (Target target : targets) {
    for (bool tightest : {false, true}) {
      VisitBulk(shape, {.tightest = tightest, .target = target}, visit);
    }
  }
}

template <int kDims>
static Bits BitsOfEveryBound(const EveryShape<kDims>& shape,
                             const std::vector<Target>& targets) {
  Bits bits;
  VisitEveryBuilder(shape, targets,
                    [&](const auto& call) { AppendBits(call(), bits); });
  return bits;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_EVERY_BUILDER_H_
