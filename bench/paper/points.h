// Objects and queries as the points that they bound, for bounds that cannot be
// made from an octahedron.
#ifndef HALFSPACE_BENCH_PAPER_POINTS_H_
#define HALFSPACE_BENCH_PAPER_POINTS_H_

#include <cstdint>
#include <functional>
#include <span>

#include "halfspace/bounds.h"

namespace halfspace::bench {

// Makes one object after the other: the coordinates of its points, at least
// one, point by point. They stay until the next call.
using NextPoints = std::function<std::span<const float>()>;

// Those of MakeScene(..., seed): objects, then queries.
NextPoints ScenePoints(std::uint64_t seed);

// The corners of boxes with sides uniform in (0, 3.5): on average, a box around
// an object of the scene has sides as long. Centers uniform in [-50, 50]^3.
NextPoints BoxPoints(std::uint64_t seed);

// An octahedron around points whose axes are (1, 1, 1), (1, -1, -1),
// (-1, 1, -1) and (-1, -1, 1): four normals of a regular tetrahedron, which sum
// to zero. The kernels know planes, and no directions.
Aabo3 BoundOnRegularAxes(std::span<const float> points);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_POINTS_H_
