// Octahedra on axes that the library does not offer, beside its own: the same
// loop over points, with another projection.
#ifndef HALFSPACE_BENCH_BASELINES_AXES_BUILDER_H_
#define HALFSPACE_BENCH_BASELINES_AXES_BUILDER_H_

#include <array>
#include <cstddef>

#include "halfspace/targets.h"

namespace halfspace::bench {

enum class Axes : std::size_t {
  kStandard,      // X, Y, Z and -(X + Y + Z)
  kRegular,       // the normals of a regular tetrahedron, of length 1
  kRegularSigns,  // of length sqrt(3), without products: (1, 1, 1),
                  // (1, -1, -1), (-1, 1, -1), (-1, -1, 1)
};
inline constexpr std::array<Axes, 3> kAllAxes = {
    Axes::kStandard, Axes::kRegular, Axes::kRegularSigns};

constexpr const char* NameOf(Axes axes) {
  constexpr const char* kNames[] = {"standard", "regular, unit normals",
                                    "regular, signs"};
  return kNames[static_cast<std::size_t>(axes)];
}

// Additions and products of the projections of a point, not counting the minima
// and maxima.
constexpr std::size_t FlopsOf(Axes axes) {
  constexpr std::size_t kFlops[] = {2, 9, 6};
  return kFlops[static_cast<std::size_t>(axes)];
}

// Of the octahedron's 8 planes, those that round.
constexpr std::size_t RoundedPlanesOf(Axes axes) {
  return axes == Axes::kStandard ? 2 : 8;
}

// The root of 1 / 3, as a float, so that the axes are the same in every
// precision.
inline constexpr float kRootOfThird = 0.57735026918962576f;

// The coefficients of the axes, exact.
using AxisMatrix = std::array<std::array<double, 3>, 4>;
AxisMatrix MatrixOf(Axes axes);

// Bounds cloud after cloud of `points_of_cloud` points, at least 16, whose
// coordinates are planes, into minima and maxima on the four axes that enclose
// them, rounding included.
//
// A projection sum c_i x_i with r roundings is wrong by at most r u S, where
// u = 2^-24 and S is the largest sum of |c_i x_i|; moving a plane outward
// rounds once more. So planes that are not copied are moved by (r + 2) u S. S
// is known from the bounds themselves: by X, Y and Z in the standard axes; in
// the regular ones by the four projections, whose signs and their opposites are
// all there are.
using BoundClouds = void (*)(Axes axes, const float* const* coordinates,
                             std::size_t clouds, std::size_t points_of_cloud,
                             float* const* min, float* const* max);

// Of a supported target.
BoundClouds BoundCloudsFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_AXES_BUILDER_H_
