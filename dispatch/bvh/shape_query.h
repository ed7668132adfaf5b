// Makes the query shapes that the kernels read (kernels/bvh/shape_query.h).
// Called in the default floating-point mode.
#ifndef HALFSPACE_DISPATCH_BVH_SHAPE_QUERY_H_
#define HALFSPACE_DISPATCH_BVH_SHAPE_QUERY_H_

#include <cstddef>

#include "halfspace/detail/plane_arrays.h"
#include "kernels/bvh/shape_query.h"

namespace halfspace::detail {

// Makes the ball of a sphere, whose center is `low` and `high`, or of a box.
void MakeBall(const PlaneLayout& planes, const float* low, const float* high,
              float radius, Ball& ball);
// Makes the line of a box from `low` to `high` that is `radius` larger on each
// side and moves by t * `direction`. A point has low == high. A bound counts as
// touched if the box touches it on each axis by itself, D included.
void MakeLine(const PlaneLayout& planes, const double* low, const double* high,
              const double* direction, float max_t, float radius, Line& line);

void MakeHalfSpaceTest(const PlaneLayout& planes, const float* normal,
                       float offset, HalfSpaceTest& test);
// Makes the tests of a list of half-spaces, each a normal and an offset.
void MakeHalfSpaceTests(const PlaneLayout& planes, const float* half_spaces,
                        std::size_t count, HalfSpaceTests& tests);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_SHAPE_QUERY_H_
