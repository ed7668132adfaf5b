// The queries of bvh.h with a point, sphere, segment, capsule, oriented box or
// half-spaces.
//
//   Survivors(bvh, Sphere3{{x, y, z}, radius}, ids)
//   CountSurvivors(bvh, Segment3{a, b})
//   ForEachSurvivor(bvh, Capsule3{a, b, radius}, function)
//   Survivors(bvh, OrientedBox3{center, {right, up, back}, half_extents}, ids)
//   AnySurvivor(bvh, frustum)        e.g. a std::array<HalfSpace3, 6>
//   SurvivorsOfEach(bvh, spheres, ids, offsets)
//
// A query shape is a Point<d>, Sphere<d>, Segment<d>, Capsule<d> or
// OrientedBox<d> of floats (shapes.h) in the world's d dimensions, or a list of
// up to 64 HalfSpace<d>: the region in front of all of them. Everything else is
// as in bvh.h.
//
// An object survives unless a test of its bound proves that the shape cannot
// touch it:
//   point: its bound is the query, exact on X, Y and Z and rounded outward on
//     D.
//   sphere: the distance of the object's box from the center, and the range of
//     D. A simplex has no box: there it is the distance of the octant above its
//     minima.
//   segment, capsule: the slab test. The parts of the segment that are within
//     the radius of the planes of each axis, D included, must overlap. Near an
//     edge, an object up to sqrt(d) * radius away can survive.
//   half-spaces: the corner of the bound that is foremost along each normal.
//     For an octahedron it is the corner of its box. An object near an edge of
//     a frustum that is behind no single plane can survive.
//   oriented box: the half-spaces of its sides, and of the sides of the
//     axis-aligned box around it. An object near an edge can survive: the
//     cross products of edges are not tested.
//
// No object whose bound touches the exact shape is rejected, in any
// floating-point mode. Objects closer than about 2^-18 of the sizes involved
// can survive (docs/bvh.md), and the mode can change which of these do. All
// targets return the same objects.
//
// NaN and infinities: planes of objects as in reject.h. A point, sphere,
// segment or capsule with a NaN in a point, with an infinity, or with
// magnitudes that sum to more than 2^125 is a query of Everything(), like the
// bound that a builder of fit.h makes of it. An oriented box with a NaN or
// an infinity keeps every object. A NaN radius is an
// error. A half-space with a NaN or an infinity keeps every object, and so does
// one whose normal has a component that is not 0 and less than 2^-96 of
// another. An empty list of half-spaces keeps every object. An Empty() object
// is found only by a query that keeps every object: a list of half-spaces, or
// an oriented box with a NaN or an infinity.
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
// a sphere, or in front of all half-spaces, are counted and listed without
// tests of their objects (not with simplices). SurvivorsOfEach() runs one query
// after another.
//
// Source: the slab method and the support function of a box are common
// knowledge.
#ifndef HALFSPACE_BVH_SHAPES_H_
#define HALFSPACE_BVH_SHAPES_H_

#include <array>  // std::data and std::size
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

#include "halfspace/bvh.h"
#include "halfspace/detail/bvh_shapes.h"
#include "halfspace/shapes.h"

namespace halfspace {

namespace detail {

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
BvhShapeQuery ShapeQueryOf(const OrientedBox<kDims>& box) {
  return ShapeQuery(BvhShapeQuery::kOrientedBox, kDims, &box, 1);
}
template <int kDims>
BvhShapeQuery ShapeQueryOf(Span<const HalfSpace<kDims>> half_spaces) {
  return ShapeQuery(BvhShapeQuery::kHalfSpaces, kDims, half_spaces.data(),
                    half_spaces.size());
}

// A type only if a Shape is one for worlds of this view.
template <typename View, typename Shape, int kDims = View::Bound::kDimensions>
using IfShapeOf = std::enable_if_t<
    std::is_same_v<Shape, Point<kDims>> ||
    std::is_same_v<Shape, Sphere<kDims>> ||
    std::is_same_v<Shape, Segment<kDims>> ||
    std::is_same_v<Shape, Capsule<kDims>> ||
    std::is_same_v<Shape, OrientedBox<kDims>> ||
    std::is_convertible_v<const Shape&, Span<const HalfSpace<kDims>>>>;

template <typename View, typename Shape>
BvhShapeQuery ShapeQueryAt(const void* shapes, std::size_t i) {
  constexpr int kDims = View::Bound::kDimensions;
  using HalfSpaces = Span<const HalfSpace<kDims>>;
  const Shape& shape = static_cast<const Shape*>(shapes)[i];
  if constexpr (std::is_convertible_v<const Shape&, HalfSpaces>) {
    return ShapeQueryOf<kDims>(HalfSpaces(shape));
  } else {
    return ShapeQueryOf<kDims>(shape);
  }
}

template <typename View, typename Shape>
inline constexpr BvhShapeKind kShapeKind = {
    alignof(Shape), &ShapeQueryAt<View, Shape>, &BvhWalkShapes};

template <typename View, typename Shape>
BvhQueries ShapeQueries(const Shape* shapes, std::size_t count) {
  return {shapes, count, &kShapeKind<View, Shape>};
}

}  // namespace detail

// Writes the ids of the survivors of one shape, as Survivors() of bvh.h does.
template <typename View, typename Shape,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::size_t Survivors(const Bvh<View>& world, const Shape& shape,
                                    Span<std::uint32_t> ids,
                                    const QueryOptions& options = {},
                                    std::size_t skip = 0) {
  return detail::BvhSurvivors(detail::TreeOf(world),
                              detail::ShapeQueries<View>(&shape, 1), ids,
                              options, skip);
}

// Returns the number of survivors of one shape.
template <typename View, typename Shape,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::size_t CountSurvivors(const Bvh<View>& world,
                                         const Shape& shape,
                                         const QueryOptions& options = {}) {
  return detail::BvhCount(detail::TreeOf(world),
                          detail::ShapeQueries<View>(&shape, 1), options);
}

// Returns the id of a survivor, or nothing, as AnySurvivor() of bvh.h does.
template <typename View, typename Shape,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::optional<std::uint32_t> AnySurvivor(
    const Bvh<View>& world, const Shape& shape,
    const QueryOptions& options = {}) {
  std::uint32_t id = 0;
  if (!detail::BvhAny(detail::TreeOf(world),
                      detail::ShapeQueries<View>(&shape, 1), id, options)) {
    return std::nullopt;
  }
  return id;
}

// Calls the function with survivors, as ForEachSurvivor() of bvh.h does.
template <typename View, typename Shape, typename Function,
          typename = detail::IfShapeOf<View, Shape>>
void ForEachSurvivor(const Bvh<View>& world, const Shape& shape,
                     Function&& function, const QueryOptions& options = {}) {
  detail::Callback call{function};
  detail::BvhForEach(detail::TreeOf(world),
                     detail::ShapeQueries<View>(&shape, 1),
                     &decltype(call)::Run, &call, options);
}

// For half-spaces, `shapes` is a list of lists: Span<const Span<const
// HalfSpace3>>.
template <typename View, typename Shapes,
          typename Shape =
              std::decay_t<decltype(*std::data(std::declval<const Shapes&>()))>,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::size_t SurvivorsOfEach(const Bvh<View>& world,
                                          const Shapes& shapes,
                                          Span<std::uint32_t> ids,
                                          Span<std::size_t> offsets,
                                          const QueryOptions& options = {},
                                          std::size_t skip = 0) {
  return detail::BvhSurvivorsOfEach(
      detail::TreeOf(world),
      detail::ShapeQueries<View>(std::data(shapes), std::size(shapes)), ids,
      offsets, options, skip);
}

}  // namespace halfspace

#endif  // HALFSPACE_BVH_SHAPES_H_
