// The objects of a sorted world (sorted.h) that are nearest to a point, or that
// a ray enters first: all in ascending order, without a query around them.
//
//   std::array<std::uint32_t, 8> ids;
//   std::array<float, 8> distances;
//   std::size_t found = NearestObjects(sorted, {x, y, z}, ids, distances);
//
//   float closest = ray.max_t;
//   ForEachAlongRay(sorted, ray, [&](std::uint32_t id, float) {
//     // HitTriangle() is infinite for a miss.
//     return closest = std::min(closest, HitTriangle(ray, id));
//   });
//
// Distances are those of bounds, not of what is in them: the distance of a
// point from the box of the first d axes, or, of a simplex, from the octant
// above its first d minima; 0 inside. A ray enters a bound where it is between
// the planes of every axis, D included; at t = 0 if its origin is. Of a simplex
// there are minima only.
//
// Every call takes
//   world     a SortedWorld of d dimensions
//   point     Point<d>, or
//   ray       Ray<d>: t from 0 to max_t, in multiples of the direction
//   function  function(std::uint32_t id, float value) with the distance or t,
//             called for one object after another. Returns nothing, or whether
//             to go on, or as a float the new limit of what is to be found.
//             Limits only shrink: one greater than the last changes nothing,
//             and a negative one ends the search. It may not change the world.
//             Exceptions pass through.
//   options   categories and target, as in sorted.h
//
// Order: by the squared distance, or t, as computed in floats, and of equal
// ones by the world's order (SortedWorld::ids()). Order and values are the same
// on every target and in every floating-point mode.
//
// Rounding: a distance is within 2^-20 (relative) or 2^-73 of the exact one,
// whichever is more. A t is at most the exact one, and within 2^-18 of it or of
// what the rounding of the origin and the planes makes of it. An object exactly
// at the limit is found. Objects up to 2^-18 (relative) plus 2^-73 beyond it
// can also be found. An object whose squared distance is no finite float, from
// about 2^64 on, is not found.
//
// NaN and infinities: a plane with a NaN limits nothing; neither does the axis
// of a coordinate or a direction that is no number, and no direction beyond
// 2^120. What is infinitely far from an infinite coordinate is not found;
// neither are Empty() objects, but by a ray that no axis limits.
//
// Errors (error.h): the target is supported; a limit or radius is negative or
// NaN; an output with room is null or misaligned; `distances` has another size
// than `ids`.
//
// Floating-point mode: any, and no call traps. The function is called in the
// thread's mode.
//
// Thread safety: as in sorted.h; 24 KiB of stack. No call allocates.
//
// Cost: a search for k objects visits about 4 + k / 16 blocks, nearest first.
//
// Source: branch and bound (Roussopoulos, Kelley and Vincent, "Nearest Neighbor
// Queries", 1995).
#ifndef HALFSPACE_SORTED_NEAREST_H_
#define HALFSPACE_SORTED_NEAREST_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "halfspace/detail/sorted_nearest.h"
#include "halfspace/shapes.h"
#include "halfspace/sorted.h"

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

// Writes the ids of the ids.size() objects that are nearest to the point, and
// within max_distance, and their distances, in ascending order. Returns how
// many there are. `distances` may be empty. Elements of `ids` after the last id
// may be overwritten.
//
// For any number k of objects it takes at most about as long as computing all
// distances and sorting the k least (docs/sorted.md). One search finds up to
// 2048 objects. More take about log2(k / 1024) searches in the memory of `ids`.
template <typename View>
[[nodiscard]] std::size_t NearestObjects(
    const SortedWorld<View>& world,
    const Point<View::Bound::kDimensions>& point, Span<std::uint32_t> ids,
    Span<float> distances,
    float max_distance = std::numeric_limits<float>::infinity(),
    const SortedOptions& options = {}) {
  return detail::SortedNearest(world.tree(), point.size(), point.data(),
                               max_distance, ids, distances, options);
}

// Calls function(id, distance) for the objects within max_distance, nearest
// first.
//
// Objects are searched for 8 at a time, then 16, and so on up to 2048. Each
// search passes over all objects that were found before, so the cost grows with
// the square of their number: of a million objects, a call for 10 000 takes 1.3
// times as long as NearestObjects(), for 100 000 twice, and for all 8 times as
// long. The same holds for ForEachAlongRay().
template <typename View, typename Function>
void ForEachNearest(const SortedWorld<View>& world,
                    const Point<View::Bound::kDimensions>& point,
                    float max_distance, Function&& function,
                    const SortedOptions& options = {}) {
  detail::NearCall<Function> call{function};
  detail::SortedForEachNearest(world.tree(), point.size(), point.data(),
                               max_distance, &detail::NearCall<Function>::Run,
                               &call, options);
}

// Calls function(id, t) for the objects that the ray enters, or comes so near
// to that their planes, moved by the radius, are passed, in the order in which
// it enters them. The limit that the function returns is one of t. max_t may be
// infinite, but the D axis tells nothing then.
template <typename View, typename Function>
void ForEachAlongRay(const SortedWorld<View>& world,
                     const Ray<View::Bound::kDimensions>& ray, float radius,
                     Function&& function, const SortedOptions& options = {}) {
  using Values = Ray<View::Bound::kDimensions>;
  static_assert(
      std::is_standard_layout_v<Values> &&
          sizeof(Values) == (2 * View::Bound::kDimensions + 1) * sizeof(float),
      "a ray is read as a list of its values");
  detail::NearCall<Function> call{function};
  detail::SortedForEachAlongRay(
      world.tree(), ray.origin.size(), reinterpret_cast<const float*>(&ray),
      radius, &detail::NearCall<Function>::Run, &call, options);
}
template <typename View, typename Function>
void ForEachAlongRay(const SortedWorld<View>& world,
                     const Ray<View::Bound::kDimensions>& ray,
                     Function&& function, const SortedOptions& options = {}) {
  ForEachAlongRay(world, ray, 0.0f, function, options);
}

}  // namespace halfspace

#endif  // HALFSPACE_SORTED_NEAREST_H_
