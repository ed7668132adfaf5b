// The calls of triangles.h, in the default floating-point mode.
#ifndef HALFSPACE_DISPATCH_BVH_TRIANGLES_H_
#define HALFSPACE_DISPATCH_BVH_TRIANGLES_H_

#include "halfspace/triangles.h"

namespace halfspace::detail {

float HitOf(const Ray<3>& ray, const Triangle<3>& triangle);
TrianglePoint ClosestOf(const Point<3>& point, const Triangle<3>& triangle);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_TRIANGLES_H_
