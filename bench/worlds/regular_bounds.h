// Bounds on the axes of a regular simplex, one at a time and as tight as floats
// are: for counts.
#ifndef HALFSPACE_BENCH_WORLDS_REGULAR_BOUNDS_H_
#define HALFSPACE_BENCH_WORLDS_REGULAR_BOUNDS_H_

#include <span>

#include "halfspace/bounds.h"

namespace halfspace::bench {

// An octahedron around points, x y z each, at least one, whose axes are
// (1, 1, 1), (1, -1, -1), (-1, 1, -1) and (-1, -1, 1): four normals of a
// regular tetrahedron, which sum to zero. The kernels know planes, and no
// directions.
Aabo3 BoundOnRegularAxes(std::span<const float> points);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_REGULAR_BOUNDS_H_
