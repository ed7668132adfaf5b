// The calls of sorted.h with a shape as the query:
//
//   Survivors(sorted, Sphere3{{x, y, z}, radius}, ids)
//   CountSurvivors(sorted, Segment3{a, b})
//   ForEachSurvivor(sorted, Capsule3{a, b, radius}, function)
//   AnySurvivor(sorted, frustum)        a std::array<HalfSpace3, 6>, say
//   SurvivorsOfEach(sorted, spheres, ids, offsets)
//
// A shape is a Sphere<d>, Segment<d> or Capsule<d> of floats (shapes.h) in the
// world's d dimensions, or a list of HalfSpace<d>, up to 64: the points in
// front of all of them. Everything else is as in sorted.h.
//
// An object survives unless a test of its bound proves that the shape cannot
// touch it:
//   sphere            the test of BoundSphere(), and the distance of the box of
//                     the first d axes from the center; simplices have minima
//                     only, so theirs is that of an octant
//   segment, capsule  the parts of the segment within the radius of the planes
//                     of each axis, D included, which have to overlap; so near
//                     an edge what is up to sqrt(d) times the radius away may
//                     survive
//   half-spaces       the corner of the bound that is foremost along each
//                     normal; of an octahedron that of its box. So a bound
//                     that is outside, as near an edge of a frustum, but not
//                     wholly behind any one plane, may survive
//
// What touches the exact shape, taken as real numbers, is never rejected. An
// object that is apart by less than about 2^-18 of the sizes involved may
// survive (docs/sorted.md). The answers are the same on every target.
//
// NaN and infinities: planes of objects as in reject.h. A sphere, segment or
// capsule that a builder of fit.h cannot bound is a query of Everything(): one
// with a NaN, an infinity, or magnitudes that sum to more than 2^125. A
// half-space with a NaN or an infinity rejects nothing, and neither does one
// whose normal has a number that is not 0 and is less than 2^-96 of another. An
// empty list of half-spaces keeps every object. An Empty() object is found only
// by a list of half-spaces that rejects nothing.
//
// Errors (error.h): those of sorted.h; a radius is negative or NaN, there are
// more than 64 half-spaces, or the pointer to them is null or misaligned.
//
// Floating-point mode: as in sorted.h, but a call may also raise invalid. What
// touches survives in every mode. Of the objects that are apart by less than
// those 2^-18, another rounding mode may keep others.
//
// Thread safety: as in sorted.h; 6 KiB of stack more.
//
// Cost: a block of 64 takes one to three times as long as with a box, and a
// call 0.1 us more. Counting does not visit nodes inside a sphere or in front
// of all half-spaces, and the other calls write the ids of their objects
// without a test (no simplices). Queries of SurvivorsOfEach() run one after
// another.
//
// Source: the slab method and the support of a box are common knowledge.
#ifndef HALFSPACE_SORTED_SHAPES_H_
#define HALFSPACE_SORTED_SHAPES_H_

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <type_traits>
#include <utility>

#include "halfspace/detail/sorted_shapes.h"
#include "halfspace/shapes.h"
#include "halfspace/sorted.h"

namespace halfspace {

namespace detail {

template <typename Shape>
SortedShapeQuery ShapeQuery(SortedShapeQuery::Kind kind, int dims,
                            const Shape* shapes, std::size_t count) {
  static_assert(
      std::is_standard_layout_v<Shape> && sizeof(Shape) % sizeof(float) == 0,
      "a shape is read as a list of its values");
  return {kind, static_cast<std::uint8_t>(dims),
          reinterpret_cast<const float*>(shapes), count};
}

template <int kDims>
SortedShapeQuery ShapeQueryOf(const Sphere<kDims>& sphere) {
  return ShapeQuery(SortedShapeQuery::kSphere, kDims, &sphere, 1);
}
template <int kDims>
SortedShapeQuery ShapeQueryOf(const Segment<kDims>& segment) {
  return ShapeQuery(SortedShapeQuery::kSegment, kDims, &segment, 1);
}
template <int kDims>
SortedShapeQuery ShapeQueryOf(const Capsule<kDims>& capsule) {
  return ShapeQuery(SortedShapeQuery::kCapsule, kDims, &capsule, 1);
}
template <int kDims>
SortedShapeQuery ShapeQueryOf(Span<const HalfSpace<kDims>> half_spaces) {
  return ShapeQuery(SortedShapeQuery::kHalfSpaces, kDims, half_spaces.data(),
                    half_spaces.size());
}

// A type only if a Shape is one for worlds of this view.
template <typename View, typename Shape, int kDims = View::Bound::kDimensions>
using IfShapeOf = std::enable_if_t<
    std::is_same_v<Shape, Sphere<kDims>> ||
    std::is_same_v<Shape, Segment<kDims>> ||
    std::is_same_v<Shape, Capsule<kDims>> ||
    std::is_convertible_v<const Shape&, Span<const HalfSpace<kDims>>>>;

template <typename View, typename Shape>
SortedShapeQuery ShapeQueryFor(const Shape& shape) {
  constexpr int kDims = View::Bound::kDimensions;
  using HalfSpaces = Span<const HalfSpace<kDims>>;
  if constexpr (std::is_convertible_v<const Shape&, HalfSpaces>) {
    return ShapeQueryOf<kDims>(HalfSpaces(shape));
  } else {
    return ShapeQueryOf<kDims>(shape);
  }
}

}  // namespace detail

template <typename View, typename Shape,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::size_t Survivors(const SortedWorld<View>& world,
                                    const Shape& shape, Span<std::uint32_t> ids,
                                    const SortedOptions& options = {}) {
  return detail::SortedSurvivors(
      world.tree(), detail::ShapeQueryFor<View>(shape), ids, options);
}

template <typename View, typename Shape,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::size_t CountSurvivors(const SortedWorld<View>& world,
                                         const Shape& shape,
                                         const SortedOptions& options = {}) {
  return detail::SortedCount(world.tree(), detail::ShapeQueryFor<View>(shape),
                             options);
}

template <typename View, typename Shape,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::optional<std::uint32_t> AnySurvivor(
    const SortedWorld<View>& world, const Shape& shape,
    const SortedOptions& options = {}) {
  std::uint32_t id = 0;
  if (!detail::SortedAny(world.tree(), detail::ShapeQueryFor<View>(shape), id,
                         options)) {
    return std::nullopt;
  }
  return id;
}

template <typename View, typename Shape, typename Function,
          typename = detail::IfShapeOf<View, Shape>>
void ForEachSurvivor(const SortedWorld<View>& world, const Shape& shape,
                     Function&& function, const SortedOptions& options = {}) {
  auto call = [&function](Span<const std::uint32_t> ids) {
    return function(ids);
  };
  detail::SortedForEach(world.tree(), detail::ShapeQueryFor<View>(shape),
                        &detail::CallWithSome<std::uint32_t, decltype(call)>,
                        &call, options);
}

// Of half-spaces, a list of lists: Span<const Span<const HalfSpace3>>.
template <typename View, typename Shapes,
          typename Shape =
              std::decay_t<decltype(*std::data(std::declval<const Shapes&>()))>,
          typename = detail::IfShapeOf<View, Shape>>
[[nodiscard]] std::size_t SurvivorsOfEach(const SortedWorld<View>& world,
                                          const Shapes& shapes,
                                          Span<std::uint32_t> ids,
                                          Span<std::size_t> offsets,
                                          const SortedOptions& options = {}) {
  return detail::SortedSurvivorsOfMany(
      world.tree(), std::data(shapes), std::size(shapes), alignof(Shape),
      [](const void* queries, std::size_t q) {
        return detail::ShapeQueryFor<View>(
            static_cast<const Shape*>(queries)[q]);
      },
      ids, offsets, options);
}

}  // namespace halfspace

#endif  // HALFSPACE_SORTED_SHAPES_H_
