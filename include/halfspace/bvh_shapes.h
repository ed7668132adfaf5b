// The queries of bvh.h with a point, sphere, segment, capsule, rounded box,
// oriented box or half-spaces.
//
//   Survivors(bvh, Sphere3{{x, y, z}, radius}, ids)
//   CountSurvivors(bvh, Segment3{a, b})
//   ForEachSurvivor(bvh, Capsule3{a, b, radius}, function)
//   Survivors(bvh, RoundedBox3{box, distance}, ids)   at most so far away
//   Survivors(bvh, OrientedBox3{center, {right, up, back}, half_extents}, ids)
//   AnySurvivor(bvh, frustum)        e.g. a std::array<HalfSpace3, 6>
//   SurvivorsOfEach(bvh, spheres, ids, offsets)
//
// This header adds types of queries to the calls of bvh.h, except
// CountSurvivorsOfEach(). A query shape is a Point<d>, Sphere<d>, Segment<d>,
// Capsule<d>, RoundedBox<d> or OrientedBox<d> of floats (shapes.h) in the
// BVH's d dimensions, or a list of up to 64 HalfSpace<d>: the region in front
// of all of them. Everything else is as in bvh.h.
//
// An object survives unless a test of its bound proves that the shape cannot
// touch it:
//   point: its bound is the query, exact on X, Y and Z and rounded outward on
//     D.
//   sphere, rounded box: the distance of the object's box from the center or
//     the box, and the range of D. A simplex has no box: there it is the
//     distance of the octant above its minima.
//   segment, capsule: the slab test. The parts of the segment that are within
//     the radius of the planes of each axis, D included, must overlap. Near an
//     edge, an object up to sqrt(d) * radius away can survive.
//   half-spaces: the corner of the bound that is foremost along each normal.
//     For an octahedron it is the corner of its box. An object near an edge of
//     a frustum that is behind no single plane can survive, unless the list has
//     the sides of its box, too (FrustumPlanes() in frustum.h).
//   oriented box: the half-spaces of its sides, and of the sides of the
//     axis-aligned box around it. An object near an edge can survive: the
//     cross products of edges are not tested.
//
// No object whose bound touches the exact shape is rejected, in any
// floating-point mode. Objects closer than about 2^-18 of the sizes involved
// can survive (docs/bvh.md), of half-spaces 2^-20. The mode can change which of
// these do, but not for half-spaces and oriented boxes. All targets return the
// same objects.
//
// NaN and infinities: planes of objects as in reject.h. A point, sphere,
// segment or capsule with a NaN in a point, with an infinity, or with
// magnitudes that sum to more than 2^125 is a query of Everything(), like the
// bound that a builder of fit.h makes of it. So is a rounded box with a NaN.
// With an infinity, with such magnitudes, or with a radius from about 2^64 on
// it is the box that is larger by the radius. If a minimum is above its
// maximum, it can find objects that touch nothing. An oriented box with a NaN
// or an infinity keeps every object. A NaN radius is an error. A half-space
// with a NaN, an infinity or a component beyond 2^126 keeps every object. An
// empty list of half-spaces keeps every object. An Empty() object is found only
// by a query that keeps every object: a list of half-spaces, or an oriented box
// with a NaN or an infinity.
//
// Errors (error.h): those of bvh.h; a radius is negative or NaN; there are
// more than 64 half-spaces; the pointer to them is null or misaligned.
//
// Floating-point mode: as in bvh.h, except that a call may also raise
// invalid.
//
// Thread safety: as in bvh.h, with 6 KiB more stack.
//
// Cost: a block takes one to three times as long as with a box, and five to
// seven times for a frustum or an oriented box, which is up to 12 half-spaces.
// A call takes up to 0.1 us more, and 0.4 us for an oriented box. Nodes inside
// a sphere or a rounded box, or in front of all half-spaces, are counted and
// listed without tests of their objects (not with simplices). SurvivorsOfEach()
// runs one query after another.
//
// Source: the slab method and the support function of a box are common
// knowledge.
#ifndef HALFSPACE_BVH_SHAPES_H_
#define HALFSPACE_BVH_SHAPES_H_

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/bvh.h"  // IWYU pragma: export
#include "halfspace/detail/bvh.h"
#include "halfspace/shapes.h"

namespace halfspace::detail {

template <typename Shape>
BvhShapeQuery ShapeQuery(BvhShapeQuery::Kind kind, int dims,
                         const Shape* shapes, std::size_t count) {
  static_assert(
      std::is_standard_layout_v<Shape> && sizeof(Shape) % sizeof(float) == 0,
      "a shape is read as a list of its values");
  return {kind, static_cast<std::uint8_t>(dims),
          reinterpret_cast<const float*>(shapes), count};
}

template <int kDims>
BvhShapeQuery ShapeQueryOf(const Point<kDims>& point) {
  return ShapeQuery(BvhShapeQuery::kPoint, kDims, &point, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(const Sphere<kDims>& sphere) {
  return ShapeQuery(BvhShapeQuery::kSphere, kDims, &sphere, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(const Segment<kDims>& segment) {
  return ShapeQuery(BvhShapeQuery::kSegment, kDims, &segment, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(const Capsule<kDims>& capsule) {
  return ShapeQuery(BvhShapeQuery::kCapsule, kDims, &capsule, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(const RoundedBox<kDims>& box) {
  return ShapeQuery(BvhShapeQuery::kRoundedBox, kDims, &box, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(const OrientedBox<kDims>& box) {
  return ShapeQuery(BvhShapeQuery::kOrientedBox, kDims, &box, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(Span<const HalfSpace<kDims>> half_spaces) {
  return ShapeQuery(BvhShapeQuery::kHalfSpaces, kDims, half_spaces.data(),
                    half_spaces.size());
}

template <typename View, typename Shape>
BvhShapeQuery ShapeQueryAt(const void* shapes, std::size_t i) {
  return ShapeQueryOf<View::Bound::kDimensions>(
      static_cast<const Shape*>(shapes)[i]);
}

template <typename View, typename Shape>
inline constexpr BvhShapeKind kShapeKind = {
    alignof(Shape), &ShapeQueryAt<View, Shape>, &BvhWalkShapes};

// Any type that an overload of ShapeQueryOf() accepts.
template <typename View, typename Shape>
struct BvhAsked<View, Shape,
                std::void_t<decltype(ShapeQueryOf<View::Bound::kDimensions>(
                    std::declval<const Shape&>()))>>
    : BvhQueriesOf<Shape, &kShapeKind<View, Shape>> {};

}  // namespace halfspace::detail

#endif  // HALFSPACE_BVH_SHAPES_H_
