// A ray and a triangle, and the closest point of a triangle: for the casts and
// searches of a BVH of their boxes (bvh_nearest.h). If the triangles do not
// move, a TriangleMesh (mesh.h) is faster, with the same results.
//
//   float closest = ray.max_t;
//   RayCast(bvh, ray, [&](std::uint32_t id, float) {
//     closest = std::min(closest, HitTriangle(ray, triangles[id]));
//     return Limit{closest};
//   });
//
// Results are the same on every target and in every floating-point mode.
//
// Thread safety: calls may run at the same time. No call allocates.
#ifndef HALFSPACE_TRIANGLES_H_
#define HALFSPACE_TRIANGLES_H_

#include <array>

#include "halfspace/export.h"
#include "halfspace/shapes.h"

namespace halfspace {

// Returns the t at which a ray hits a triangle, from either side, or infinity
// if it does not.
//
// Whether the line of the ray meets the triangle, its edges and corners
// included, is decided exactly. So no ray passes between two triangles that
// share an edge or a corner, and a ray that hits the edge hits both. The number
// of hits is therefore not always odd inside of a closed mesh: do not decide by
// it whether a point is inside.
//
// The exception is a triangle in whose plane the ray lies, or without an area:
// no ray hits it. Whether t is negative is also decided exactly, and t is one
// of the two floats next to the exact value, or this itself.
//
// A NaN or an infinity in the origin, the direction or the triangle is a miss.
HALFSPACE_API float HitTriangle(const Ray<3>& ray, const Triangle<3>& triangle);

struct TrianglePoint {
  std::array<float, 3> point;
  float distance;
};

// Returns the point of a triangle that is closest to a point, and its distance.
// Computed in double: errors are about 2^-24 of each result, plus 2^-45 of the
// distance to the farthest corner. All numbers must be finite.
HALFSPACE_API TrianglePoint ClosestPoint(const Point<3>& point,
                                         const Triangle<3>& triangle);

}  // namespace halfspace

#endif  // HALFSPACE_TRIANGLES_H_
