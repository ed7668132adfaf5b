// The bounds of one sample of every shape by every builder, as bits: for what
// must not change any of them, such as the caller's floating-point mode and
// compiler flags.
//
// The functions are static so that every translation unit has its own, compiled
// with its own flags. They do no arithmetic: only the library does.
#ifndef HALFSPACE_TESTS_LIBRARY_EVERY_BUILDER_H_
#define HALFSPACE_TESTS_LIBRARY_EVERY_BUILDER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
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

template <int kDims>
static void AppendFits(const EveryShape<kDims>& s, Bits& bits) {
  const Points<kDims> points{s.points[0].data(), s.points.size()};
  const Points<kDims, double> wide{s.wide_points[0].data(),
                                   s.wide_points.size()};
  const std::array<std::uint32_t, 2> last = {2, 1};
  const Segment<kDims> segment{s.points[0], s.points[1]};
  AppendBits(BoundPoints(points), bits);
  AppendBits(BoundPoints(wide), bits);
  AppendBits(BoundPoints<kDims>(points, last), bits);
  AppendBits(BoundPoint<kDims>(s.points[0]), bits);
  AppendBits(BoundSegment(segment), bits);
  AppendBits(BoundTriangle<kDims>({s.points[0], s.points[1], s.points[2]}),
             bits);
  AppendBits(BoundRay(s.ray), bits);
  std::array<Aabo<kDims>, 3> pieces;
  BoundSegmentPieces<kDims>(segment, pieces);
  for (const auto& piece : pieces) AppendBits(piece, bits);
  AppendBits(BoundAabb(s.box), bits);
  AppendBits(BoundAabb(s.wide_box), bits);
  AppendBits(BoundOrientedBox(s.oriented_box), bits);
  AppendBits(BoundSphere(s.sphere), bits);
  AppendBits(BoundSphere(s.wide_sphere), bits);
  AppendBits(BoundCapsule(s.capsule), bits);
  AppendBits(BoundFrustum(s.planes), bits);
  AppendBits(BoundTransformed(points, s.map), bits);
  AppendBits(BoundTransformed(s.box, s.map), bits);
}

template <int kDims>
static void AppendTransforms(const EveryShape<kDims>& s, Bits& bits) {
  const auto append = [&](const auto& bound) {
    AppendBits(Merge(bound, bound), bits);
    AppendBits(Inflate(bound, s.length), bits);
    AppendBits(InflateByBox(bound, s.length), bits);
    AppendBits(Translate(bound, s.move), bits);
    AppendBits(Scale(bound, s.length), bits);
    AppendBits(Sweep(bound, s.move), bits);
  };
  append(s.bound);
  append(s.bound.up());
  append(s.bound.down());
  append(s.bound.aabb());
  AppendBits(TranslateVertices(s.bound, s.move), bits);
  AppendBits(TranslateVertices(s.bound.aabb(), s.move), bits);
  AppendBits(Scale(s.bound, s.factor), bits);
  AppendBits(Scale(s.bound.aabb(), s.factor), bits);
  const auto down = Circumscribe(s.simplex);
  AppendBits(down, bits);
  AppendBits(Circumscribe(down), bits);
}

template <int kDims>
static void AppendBulk(const EveryShape<kDims>& s, const FitOptions& options,
                       Bits& bits) {
  const auto append = [&](auto build) {
    AaboWorld<kDims> world;
    world.Resize(EveryShape<kDims>::kMany);
    build(world.planes());
    for (std::size_t i = 0; i < world.size(); ++i) {
      AppendBits(world.Get(i), bits);
    }
  };
  Spheres<kDims> spheres{.radius = &s.spheres[0].radius,
                         .count = s.spheres.size(),
                         .stride = sizeof(Sphere<kDims>) / sizeof(float)};
  for (std::size_t k = 0; k < kDims; ++k) {
    spheres.center[k] = s.spheres[0].center.data() + k;
  }
  const Points<kDims> vertices{s.vertices[0].data(), s.vertices.size()};
  append([&](const auto& planes) {
    BoundBoxes(BoxesOf<kDims>(s.boxes), planes, options);
  });
  append([&](const auto& planes) { BoundSpheres(spheres, planes, options); });
  append([&](const auto& planes) {
    BoundTriangles(vertices, s.indices, planes, options);
  });
  append([&](const auto& planes) {
    BoundPointSets(vertices, s.ends, planes, options);
  });
}

// On the given targets.
template <int kDims>
static Bits BitsOfEveryBound(const EveryShape<kDims>& shape,
                             const std::vector<Target>& targets) {
  Bits bits;
  AppendFits(shape, bits);
  AppendTransforms(shape, bits);
  for (Target target : targets) {
    for (bool tightest : {false, true}) {
      AppendBulk(shape, {.tightest = tightest, .target = target}, bits);
    }
  }
  return bits;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_EVERY_BUILDER_H_
