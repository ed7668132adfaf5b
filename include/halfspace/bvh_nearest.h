// k nearest and ray casts on the BVH of bvh.h: the objects nearest to a
// point, or first along a ray, in ascending order.
//
//   std::array<std::uint32_t, 8> ids;
//   std::array<float, 8> distances;
//   std::size_t found = KNearest(bvh, {x, y, z}, ids, distances);
//
//   float closest = ray.max_t;
//   RayCast(bvh, ray, [&](std::uint32_t id, float) {
//     // HitTriangle() is infinite for a miss.
//     return closest = std::min(closest, HitTriangle(ray, id));
//   });
//
// Distances are distances of bounds, not of the objects in them: from the point
// to the box of the first d axes, or to the octant above the first d minima of
// a simplex. Inside the bound the distance is 0. A ray enters a bound where it
// is between the planes of all axes, D included (a simplex has minima only). If
// its origin is inside, t is 0.
//
// A callback is function(std::uint32_t id, float value), called for one object
// after another with the distance or t. It returns void, or bool (false ends
// the search), or float: a new limit of the distance or t. A limit greater than
// the last one changes nothing, and a negative one ends the search. The
// callback must not change the world. Its exceptions pass through.
//
// Order: by the squared distance, or t, as computed in float. Equal ones come
// in the world's order (Bvh::ids()). Order and values are the same on
// every target and in every floating-point mode. No call traps.
//
// Errors (error.h): the target is not supported; a limit or radius is negative
// or NaN; an output with room is null or misaligned; `distances` is not empty
// and has another size than `ids`.
//
// Thread safety: as in bvh.h, with 24 KiB of stack. No call allocates.
//
// Cost: a search for k objects visits about 4 + k / 16 blocks, nearest first.
//
// Source: branch and bound (Roussopoulos, Kelley and Vincent, "Nearest Neighbor
// Queries", 1995).
#ifndef HALFSPACE_BVH_NEAREST_H_
#define HALFSPACE_BVH_NEAREST_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "halfspace/bvh.h"
#include "halfspace/detail/bvh_nearest.h"
#include "halfspace/shapes.h"

namespace halfspace {

namespace detail {

// A function of the caller's as a NearFunction.
template <typename Function>
struct NearCall {
  Function& function;

  static float Run(void* context, std::uint32_t id, float value) {
    auto& function = static_cast<NearCall*>(context)->function;
    using Result = decltype(function(id, value));
    static_assert(std::is_void_v<Result> || std::is_same_v<Result, bool> ||
                      std::is_same_v<Result, float>,
                  "the function returns nothing, whether to go on, or a limit");
    if constexpr (std::is_void_v<Result>) {
      function(id, value);
      return kInf<float>;
    } else if constexpr (std::is_same_v<Result, bool>) {
      return function(id, value) ? kInf<float> : -1.0f;
    } else {
      return function(id, value);
    }
  }
};

}  // namespace detail

// Writes the ids of the `ids.size()` objects that are nearest to the point and
// within `max_distance`, and their distances, in ascending order. Returns their
// number. `distances` may be empty. Elements of `ids` behind the last id may be
// overwritten.
//
// Rounding: a distance is within 2^-20 (relative) or 2^-73 of the exact one,
// whichever is more. An object exactly at the limit is found. Objects up to
// 2^-18 (relative) plus 2^-73 beyond it can also be found. An object whose
// squared distance is no finite float, from about 2^64 on, is not found.
//
// NaN and infinities: a plane with a NaN, and the axis of a coordinate that is
// a NaN, limits nothing. An object infinitely far from an infinite coordinate
// is not found. An Empty() object is found only if all coordinates are NaN.
//
// Cost: for any number of objects at most about the time to compute all
// distances and sort the least ones (docs/bvh.md). One search finds up to
// 2048 objects. A call for more takes about log2(k / 1024) further searches,
// which use `ids` as scratch memory.
template <typename View>
[[nodiscard]] std::size_t KNearest(
    const Bvh<View>& world, const Point<View::Bound::kDimensions>& point,
    Span<std::uint32_t> ids, Span<float> distances,
    float max_distance = std::numeric_limits<float>::infinity(),
    const QueryOptions& options = {}) {
  return detail::BvhNearest(detail::TreeOf(world), point.size(), point.data(),
                            max_distance, ids, distances, options);
}

// Calls function(id, distance) for the objects within `max_distance`, nearest
// first. Rounding, NaN and infinities as in KNearest().
//
// Cost: objects are searched for 8 at a time, then 16, and so on up to 2048.
// Each search passes over all objects that were found before, so the cost grows
// with the square of their number. Of a million objects, a call for 10 000
// takes about 1.3 times as long as KNearest(), for 100 000 1.5 to 2
// times, and for all 5 to 8 times. The same holds for RayCast().
template <typename View, typename Function>
void ForEachNearest(const Bvh<View>& world,
                    const Point<View::Bound::kDimensions>& point,
                    float max_distance, Function&& function,
                    const QueryOptions& options = {}) {
  detail::NearCall<Function> call{function};
  detail::BvhForEachNearest(detail::TreeOf(world), point.size(), point.data(),
                            max_distance, &detail::NearCall<Function>::Run,
                            &call, options);
}

// Ray cast: calls function(id, t) for the objects that the ray enters, in the
// order in which it enters them. t is from 0 to `ray.max_t`, in multiples of
// the direction. With a `radius`, the planes of the objects are moved outward
// by it, so an object near an edge up to sqrt(d) * radius away can be found.
// `ray.max_t` may be infinite, but then the D axis rejects nothing.
//
// Rounding: t is at most the exact value, and within 2^-18 of it, or of what
// the rounding of the origin and the planes amounts to. No object that the ray
// enters up to the limit is left out.
//
// NaN and infinities: a plane with a NaN limits nothing, and neither does an
// axis on which the origin is not finite, or the direction is not finite or
// beyond 2^120. An Empty() object is found only by a ray that no axis limits.
template <typename View, typename Function>
void RayCast(const Bvh<View>& world, const Ray<View::Bound::kDimensions>& ray,
             float radius, Function&& function,
             const QueryOptions& options = {}) {
  using Values = Ray<View::Bound::kDimensions>;
  static_assert(
      std::is_standard_layout_v<Values> &&
          sizeof(Values) == (2 * View::Bound::kDimensions + 1) * sizeof(float),
      "a ray is read as a list of its values");
  detail::NearCall<Function> call{function};
  detail::BvhRayCast(detail::TreeOf(world), ray.origin.size(),
                     reinterpret_cast<const float*>(&ray), radius,
                     &detail::NearCall<Function>::Run, &call, options);
}
template <typename View, typename Function>
void RayCast(const Bvh<View>& world, const Ray<View::Bound::kDimensions>& ray,
             Function&& function, const QueryOptions& options = {}) {
  RayCast(world, ray, 0.0f, function, options);
}

}  // namespace halfspace

#endif  // HALFSPACE_BVH_NEAREST_H_
