// The order in which the experiments evaluate the planes of a shape in 3
// dimensions: those of a box axis by axis, those of an octahedron simplex by
// simplex, as in the paper.
#ifndef HALFSPACE_BENCH_INNER_PLANE_ORDER_H_
#define HALFSPACE_BENCH_INNER_PLANE_ORDER_H_

#include <array>
#include <cstddef>

namespace halfspace::bench {

// One half-space test. Planes and values are all minima, then all maxima.
struct Plane {
  std::size_t object;  // index of the stored plane
  std::size_t query;   // index of the query's value
  bool is_min;         // rejects if object > query; else if object < query
};

inline constexpr std::array<Plane, 4> kSimplexOrder = {
    {{0, 0, true}, {1, 1, true}, {2, 2, true}, {3, 3, true}}};

inline constexpr std::array<Plane, 6> kAabbOrder = {{{0, 3, true},
                                                     {3, 0, false},
                                                     {1, 4, true},
                                                     {4, 1, false},
                                                     {2, 5, true},
                                                     {5, 2, false}}};

inline constexpr std::array<Plane, 8> kAaboOrder = {{{0, 4, true},
                                                     {1, 5, true},
                                                     {2, 6, true},
                                                     {3, 7, true},
                                                     {4, 0, false},
                                                     {5, 1, false},
                                                     {6, 2, false},
                                                     {7, 3, false}}};

// A constant: no std::array function may be called from per-target code.
template <const auto& kOrder, std::size_t kIndex>
inline constexpr Plane kPlaneOf = kOrder[kIndex];

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INNER_PLANE_ORDER_H_
