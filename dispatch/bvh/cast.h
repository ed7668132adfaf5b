// How the arguments of a ray or box cast become those of the kernel.
#ifndef HALFSPACE_DISPATCH_BVH_CAST_H_
#define HALFSPACE_DISPATCH_BVH_CAST_H_

#include "halfspace/bvh_nearest.h"
#include "kernels/bvh/nearest.h"
#include "kernels/bvh/shape.h"

namespace halfspace::detail {

// Throws unless it is a cast.
const BvhNearestKernels& CheckCast(const LineCast& cast, Target target);

// In the default floating-point mode. Returns whether the box can touch
// anything.
bool MakeCastLine(const PlaneLayout& layout, const LineCast& cast, Line& line);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_CAST_H_
