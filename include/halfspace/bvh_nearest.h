// k nearest, ray casts and box casts on the BVH of bvh.h.
//
//   std::array<std::uint32_t, 8> ids;
//   std::array<float, 8> distances;
//   std::size_t found = KNearest(bvh, {x, y, z}, ids, distances);
//
//   float closest = ray.max_t;
//   RayCast(bvh, ray, [&](std::uint32_t id, float) {
//     // HitTriangle() is infinite for a miss.
//     closest = std::min(closest, HitTriangle(ray, id));
//     return Limit{closest};
//   });
//
// Distances are distances of bounds, not of the objects in them: from the point
// or box of the query to the box of the first d axes, or to the octant above
// the first d minima of a simplex. If the two touch, the distance is 0. A ray
// enters a bound where it is between the planes of all axes, D included (a
// simplex has minima only). If its origin is inside, t is 0.
//
// A callback is function(std::uint32_t id, float value), or function(id, value,
// const Bound&) to get the bound of the object too. It is called for one object
// after another with the distance or t, and returns nothing, a Visit, or a
// Limit of the distance or t (visit.h). A negative limit ends the search, and a
// NaN changes nothing. The callback must not change the BVH. Its exceptions
// pass through. It runs in the caller's floating-point mode.
//
// Results are the same on every target and in every floating-point mode. No
// call traps.
//
// Errors (error.h): the target is not supported; `max_distance`, `max_t` or
// `radius` is negative or NaN; an output with room or a list of queries is null
// or misaligned; `distances` is not empty and has another size than `ids`; in
// KNearestOfEach(), `ids.size()` is not the number of queries times `k`.
//
// Thread safety: as in bvh.h, with 24 KiB of stack. No call allocates.
//
// Source: branch and bound (Roussopoulos, Kelley and Vincent, "Nearest Neighbor
// Queries", 1995).
#ifndef HALFSPACE_BVH_NEAREST_H_
#define HALFSPACE_BVH_NEAREST_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "halfspace/bounds.h"
#include "halfspace/bvh.h"
#include "halfspace/detail/bvh.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/visit.h"

namespace halfspace {

// Options of searches and casts.
struct SearchOptions {
  // Finds only objects whose mask (Bvh::SetMasks) has at least one of these
  // bits: all ones finds all objects, and 0 none.
  std::uint32_t mask = 0xFFFFFFFF;
  Target target = {};  // by default, the chosen one (targets.h)
  // If true, a search for the k nearest leaves out each object that is equal to
  // the query, such as the query itself. It compares the minima and maxima of
  // the first d axes, and of a simplex only the minima. A NaN is equal to
  // nothing. Casts ignore this option.
  bool exclusive = false;
};

namespace detail {

// The bound whose planes are `kStride` values apart.
template <typename Bound, std::size_t kStride>
Bound BoundFrom(const float* planes) {
  PlaneValues<Bound> values;
  for (std::size_t p = 0; p < values.size(); ++p) {
    values[p] = planes[p * kStride];
  }
  return BoundOf<Bound>(values);
}

// A function of the caller's, with or without a bound, that takes the bound's
// planes, `kStride` values apart.
template <typename Bound, std::size_t kStride = kBlockObjects,
          typename Function>
auto WithPlanes(Function& function) {
  return [&function](std::uint32_t id, float value, const float* planes) {
    if constexpr (std::is_invocable_v<Function&, std::uint32_t, float,
                                      const Bound&>) {
      const auto bound = BoundFrom<Bound, kStride>(planes);
      return function(id, value, bound);
    } else {
      return function(id, value);
    }
  };
}

template <std::size_t kDims>
NearQueries NearQueriesOf(Span<const std::array<float, kDims>> points) {
  return {reinterpret_cast<const float*>(points.data()), 0, kDims,
          points.size()};
}
template <int kDims>
NearQueries NearQueriesOf(Span<const Aabb<kDims>> boxes) {
  return {RecordsOf(boxes), kDims, 2 * kDims, boxes.size()};
}

template <int kDims>
LineCast LineOf(const Ray<kDims>& ray, float radius) {
  return {"RayCast",         ray.origin.data(),
          ray.origin.data(), ray.direction.data(),
          ray.max_t,         radius};
}
template <int kDims>
LineCast LineOf(const Aabb<kDims>& box, const Point<kDims>& direction,
                float max_t) {
  return {"BoxCast",        box.min.data(), box.max.data(),
          direction.data(), max_t,          0.0f};
}
template <int kDims>
LineCast LineOf(const Sphere<kDims>& sphere, const Point<kDims>& direction,
                float max_t) {
  return {"SphereCast",
          sphere.center.data(),
          sphere.center.data(),
          direction.data(),
          max_t,
          sphere.radius,
          true};
}

template <typename View, typename Core, typename Function>
void CastLine(const Core& core, const LineCast& cast, Function& function,
              const SearchOptions& options) {
  Callback call{WithPlanes<typename View::Bound>(function)};
  core.Cast(cast, &decltype(call)::Run, &call, options);
}

}  // namespace detail

// The id of no object.
inline constexpr std::uint32_t kNoId = detail::kNoId;

// Writes the ids of the `ids.size()` objects that are nearest to the point and
// within `max_distance`, and their distances, in ascending order. Returns their
// number. `distances` may be empty. Elements of `ids` behind the last id may be
// overwritten.
//
// Order: by the squared distance as computed in float. Equal ones come in the
// BVH's order (Bvh::ids()).
//
// Rounding: a distance is within 2^-20 (relative) or 2^-73 of the exact one,
// whichever is more. An object exactly at the limit is found. Objects up to
// 2^-18 (relative) plus 2^-73 beyond it can also be found. An object whose
// squared distance is no finite float, from about 2^64 on, is not found.
//
// NaN and infinities: a plane with a NaN, and the axis of a coordinate that is
// a NaN, limits nothing. An object infinitely far from an infinite coordinate
// is not found. An Empty() object is found only if every axis of the query is a
// NaN or, for a box, reaches from -infinity to infinity.
//
// Cost: a search for k objects visits about 4 + k / 16 blocks, nearest first.
// For any number of objects it takes at most about the time to compute all
// distances and sort the least ones (docs/bvh.md). One search finds up to
// 2048 objects. A call for more takes about log2(k / 2048) further searches,
// which use `ids` as scratch memory.
template <typename Tree, typename View = detail::SearchedView<Tree>>
[[nodiscard]] std::size_t KNearest(
    const Tree& tree, const Point<View::Bound::kDimensions>& point,
    Span<std::uint32_t> ids, Span<float> distances,
    float max_distance = std::numeric_limits<float>::infinity(),
    const SearchOptions& options = {}) {
  return detail::CoreOf(tree).Nearest({point.data(), 0, 0, 1}, max_distance,
                                      ids, distances, options);
}

// Finds the objects nearest to an Aabb, as those nearest to a point. The
// distance between two boxes that overlap is 0. An Empty() box finds nothing.
// `box.min` must not be greater than `box.max` on any other box: the distances
// would have no meaning.
template <
    typename Tree, typename Box, typename View = detail::SearchedView<Tree>,
    typename =
        std::enable_if_t<std::is_same_v<Box, Aabb<View::Bound::kDimensions>>>>
[[nodiscard]] std::size_t KNearest(
    const Tree& tree, const Box& box, Span<std::uint32_t> ids,
    Span<float> distances,
    float max_distance = std::numeric_limits<float>::infinity(),
    const SearchOptions& options = {}) {
  return detail::CoreOf(tree).Nearest(
      detail::NearQueriesOf(Span<const Box>(&box, 1)), max_distance, ids,
      distances, options);
}

// KNearest() of many points: row i of `ids` and `distances` is elements
// i * k ... i * k + k - 1, and has the objects nearest to point i. If there are
// fewer than k, the rest of the row is kNoId and infinity.
//   ids        `ids.size()` must be `points.size() * k`
//   distances  may be empty
// `ids` and `distances` must not overlap the points.
template <typename Tree, typename View = detail::SearchedView<Tree>>
void KNearestOfEach(const Tree& tree,
                    Span<const Point<View::Bound::kDimensions>> points,
                    std::size_t k, Span<std::uint32_t> ids,
                    Span<float> distances,
                    float max_distance = std::numeric_limits<float>::infinity(),
                    const SearchOptions& options = {}) {
  detail::CoreOf(tree).NearestOfEach(detail::NearQueriesOf(points), k,
                                     max_distance, ids, distances, options);
}
template <typename Tree, typename View = detail::SearchedView<Tree>>
void KNearestOfEach(const Tree& tree,
                    Span<const Aabb<View::Bound::kDimensions>> boxes,
                    std::size_t k, Span<std::uint32_t> ids,
                    Span<float> distances,
                    float max_distance = std::numeric_limits<float>::infinity(),
                    const SearchOptions& options = {}) {
  detail::CoreOf(tree).NearestOfEach(detail::NearQueriesOf(boxes), k,
                                     max_distance, ids, distances, options);
}

// Calls the function for the objects within `max_distance`, nearest first.
// Order, rounding, NaN and infinities as in KNearest().
//
// Cost: objects are searched for 8 at a time, then 16, and so on up to 2048.
// Each search passes over all objects that were found before, so the cost grows
// with the square of their number. Of a million objects, a call for 10 000
// takes about 1.3 times as long as KNearest(), for 100 000 1.5 to 2
// times, and for all 5 to 8 times.
template <typename View, typename Function>
void ForEachNearest(const Bvh<View>& bvh,
                    const Point<View::Bound::kDimensions>& point,
                    float max_distance, Function&& function,
                    const SearchOptions& options = {}) {
  detail::Callback call{detail::WithPlanes<typename View::Bound>(function)};
  detail::CoreOf(bvh).ForEachNearest({point.data(), 0, 0, 1}, max_distance,
                                     &decltype(call)::Run, &call, options);
}

// Ray cast: calls the function for the objects that the ray enters. t is from 0
// to `ray.max_t`, in multiples of the direction. With a `radius`, the planes of
// the objects are moved outward by it, so an object near an edge up to
// sqrt(d) * radius away can be found. `ray.max_t` may be infinite.
//
// Order: near to far, but not sorted. The leaf of the BVH that the ray enters
// first comes first, and the objects of a leaf come by ascending t. No object
// that the ray enters up to the current limit is left out, and no object beyond
// it is found. The example above finds the first hit.
//
// Rounding: t is at most the exact value. It is less by at most 2^-18
// (relative), or by the error from rounding the origin and the planes. Up to
// 2^-100 beyond a limit counts as at the limit.
//
// NaN and infinities: a plane with a NaN limits nothing, and neither does an
// axis on which the origin or the direction is a NaN, the origin is beyond
// 2^99, or the direction is beyond 2^120. An Empty() object is found only by a
// ray that no axis limits.
//
// Cost: one pass, which visits only nodes that the ray enters up to the current
// limit.
template <typename Tree, typename Function,
          typename View = detail::SearchedView<Tree>>
void RayCast(const Tree& tree, const Ray<View::Bound::kDimensions>& ray,
             float radius, Function&& function,
             const SearchOptions& options = {}) {
  detail::CastLine<View>(detail::CoreOf(tree), detail::LineOf(ray, radius),
                         function, options);
}
template <typename Tree, typename Function,
          typename View = detail::SearchedView<Tree>>
void RayCast(const Tree& tree, const Ray<View::Bound::kDimensions>& ray,
             Function&& function, const SearchOptions& options = {}) {
  RayCast(tree, ray, 0.0f, function, options);
}

// Box cast, or sweep: calls the function for the objects that the box touches
// on its way from `box` to `box` + max_t * `direction`. t is where it first
// touches the bound on all axes, D included. Everything else is as in
// RayCast(). An Empty() box, or one with min > max on an axis, finds nothing.
template <typename Tree, typename Function,
          typename View = detail::SearchedView<Tree>>
void BoxCast(const Tree& tree, const Aabb<View::Bound::kDimensions>& box,
             const Point<View::Bound::kDimensions>& direction, float max_t,
             Function&& function, const SearchOptions& options = {}) {
  detail::CastLine<View>(detail::CoreOf(tree),
                         detail::LineOf(box, direction, max_t), function,
                         options);
}

// Sphere cast: the same for the objects that `sphere` touches on its way to its
// center + max_t * `direction`. t is where its distance from the object's box
// becomes the radius, and, for an octahedron, its range of D touches the
// object's (Sphere of bvh_shapes.h). The corners and edges are round, unlike
// those of RayCast() with a radius.
//
// Rounding: t is at most the exact value, and no hit is missed. t is less by
// at most 2^-18 (relative), or by the error from rounding the center, the
// radius and the planes to 2^-20 of their magnitudes. A sphere that misses a
// box by less can hit it.
//
// An axis with a NaN or an infinity limits nothing. An inverted bound
// (min > max) is hit as by RayCast() with the radius.
template <typename Tree, typename Function,
          typename View = detail::SearchedView<Tree>>
void SphereCast(const Tree& tree,
                const Sphere<View::Bound::kDimensions>& sphere,
                const Point<View::Bound::kDimensions>& direction, float max_t,
                Function&& function, const SearchOptions& options = {}) {
  detail::CastLine<View>(detail::CoreOf(tree),
                         detail::LineOf(sphere, direction, max_t), function,
                         options);
}

}  // namespace halfspace

#endif  // HALFSPACE_BVH_NEAREST_H_
