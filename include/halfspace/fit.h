// Builders of single bounds: a tight float k-DOP that encloses a shape.
//
//   const halfspace::Sphere3 sphere = {{0, 0, 0}, 1.5f};
//   const halfspace::Aabo3 bound = halfspace::BoundSphere(sphere);
//   const halfspace::Aabb3 box = bound.aabb();  // for an AabbWorld3
//
// No overlap is ever missed. A builder takes every finite input number as an
// exact real number, and its bound encloses the exact set that these numbers
// describe: no minimum is above and no maximum is below the exact value. So two
// shapes that overlap or touch are never rejected, with any builders on any
// targets. docs/exactness.md has the proof.
//
// The result is an Aabo (an 8-DOP in 3D). Use its up() for the objects of a
// simplex world, its down() for the queries, and its aabb() for a box. Shapes
// are of floats (Segment3) or doubles (Segment<3, double>). Bounds are of
// floats in both cases. transform.h builds bounds from bounds (moving bodies),
// fit_many.h bounds many shapes at once.
//
// Tightness, here, in transform.h and in fit_many.h: X, Y and Z of points and
// boxes of floats are copied. Every other value is at most one float looser
// than the tightest, plus 2^-40 of the sum of the magnitudes that were added. A
// value of this header and of transform.h is the tightest float if doubles hold
// the sums.
//
// Words in the comments below:
//   Everything()   The result if finite floats cannot bound the shape: if an
//                  input is NaN or infinite, or if the magnitudes of the
//                  numbers that make up a point (its coordinates, a radius,
//                  products with a map) sum to more than 2^125. No finite query
//                  rejects it, and `status` counts it.
//   Throws         Reports a violated precondition (error.h).
// `status` can be null; fit_status.h says what it counts.
//
// Thread safety: pure functions. The caller's floating-point mode (rounding,
// flushing of subnormals, traps) and fast-math do not matter: builders work in
// the default mode and restore the caller's. A builder never traps. It can
// raise exception flags, and clears none.
//
// Cost: tens to hundreds of ns, and about 5 ns per point of a set
// (`./bench.sh --details build`). Doubles take up to twice as long.
//
// Source: "The Bounding Simplex", for the axes. The outward rounding is this
// library's own.
#ifndef HALFSPACE_FIT_H_
#define HALFSPACE_FIT_H_

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/bounds.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/transform.h"  // IWYU pragma: export

namespace halfspace {

namespace detail {

// A shape of a type below, and the Aabo of as many dimensions for its bound.
struct AnyShape {
  const void* shape;
  int dims;
  bool is_double;
  void* bound;
};

// With `indices`, of these points only.
HALFSPACE_API void BoundPoints(const AnyShape& points,
                               const Span<const std::uint32_t>* indices,
                               FitStatus* status);
HALFSPACE_API void BoundPointsSoa(const AnyShape& points,
                                  const Span<const std::uint32_t>* indices,
                                  FitStatus* status);
HALFSPACE_API void BoundSegment(const AnyShape& segment, FitStatus* status);
HALFSPACE_API void BoundTriangle(const AnyShape& triangle, FitStatus* status);
HALFSPACE_API void BoundRay(const AnyShape& ray, FitStatus* status);
HALFSPACE_API void BoundAabb(const AnyShape& box, FitStatus* status);
HALFSPACE_API void BoundSphere(const AnyShape& sphere, FitStatus* status);
HALFSPACE_API void BoundCapsule(const AnyShape& capsule, FitStatus* status);
HALFSPACE_API void BoundOrientedBox(const AnyShape& box, FitStatus* status);
// The bound is an array of `pieces`.
HALFSPACE_API void BoundSegmentPieces(const AnyShape& segment,
                                      std::size_t pieces, FitStatus* status);
// `map` is an Affine of as many dimensions.
HALFSPACE_API void BoundImageOfPoints(const AnyShape& points, const void* map,
                                      bool is_map_double, FitStatus* status);
HALFSPACE_API void BoundImageOfBox(const AnyShape& box, const void* map,
                                   bool is_map_double, FitStatus* status);

template <int kDims, typename Scalar>
AnyShape ShapeOf(const void* shape, void* bound) {
  static_assert(2 <= kDims && kDims <= 4, "bounds have 2, 3 or 4 dimensions");
  static_assert(std::is_same_v<Scalar, float> || std::is_same_v<Scalar, double>,
                "shapes are of floats or doubles");
  return {shape, kDims, std::is_same_v<Scalar, double>, bound};
}

// Calls build(shape, arguments...), and returns the bound.
template <int kDims, typename Scalar, typename... Parameters,
          typename... Arguments>
Aabo<kDims> Built(void (*build)(const AnyShape&, Parameters...),
                  const void* shape, const Arguments&... arguments) {
  Aabo<kDims> bound;
  build(ShapeOf<kDims, Scalar>(shape, &bound), arguments...);
  return bound;
}

}  // namespace detail

// Bounds the convex hull of a point set, stored as an array of structures or as
// a structure of arrays. Returns Empty() if there are no points.
//   Throws if `points.count > 0` and a pointer is null or misaligned, or the
//   points do not fit the address space.
//   Everything() if any of the points is NaN, infinite or too large (above).
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundPoints(const Points<kDims, Scalar>& points,
                        FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundPoints, &points, nullptr,
                                      status);
}
template <int kDims, typename Scalar>
Aabo<kDims> BoundPoints(const PointsSoa<kDims, Scalar>& points,
                        FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundPointsSoa, &points, nullptr,
                                      status);
}

// Bounds only the points with these indices, for example one bound for a whole
// triangle mesh. The order of the indices does not matter, and an index may
// repeat. Returns Empty() if there are no indices.
//   Throws also if an index is not below `points.count`, or if there are
//   indices and the pointer to them is null or misaligned.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundPoints(const Points<kDims, Scalar>& points,
                        Span<const std::uint32_t> indices,
                        FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundPoints, &points, &indices,
                                      status);
}
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundPoints(const PointsSoa<kDims, Scalar>& points,
                        Span<const std::uint32_t> indices,
                        FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundPointsSoa, &points,
                                      &indices, status);
}

// Bounds one point. Call as BoundPoint<3>({x, y, z}).
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundPoint(const Point<kDims, Scalar>& point,
                       FitStatus* status = nullptr) {
  return BoundPoints(Points<kDims, Scalar>{point.data(), 1}, status);
}

// Bounds a segment, including both ends.
//   A single bound fits a long diagonal segment poorly. Use BoundSegmentPieces
//   for those.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundSegment(const Segment<kDims, Scalar>& segment,
                         FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundSegment, &segment, status);
}

// Bounds a triangle.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundTriangle(const Triangle<kDims, Scalar>& triangle,
                          FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundTriangle, &triangle,
                                      status);
}

// Bounds a ray up to its maximum distance.
//   Throws if `ray.max_t` is negative or NaN. Everything() if it is infinite;
//   pass the distance at which your world ends instead.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundRay(const Ray<kDims, Scalar>& ray,
                     FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundRay, &ray, status);
}

// Cuts a segment into `pieces.size()` equal pieces and writes a bound of each
// piece, in order from a to b. Together the bounds enclose the whole segment,
// and neighbours share the point where they meet. Test each piece as a query of
// its own: n pieces of a long diagonal segment keep far fewer objects than one
// bound of the whole segment (docs/exactness.md has figures). For a ray, pass
// the segment that it covers. For a moving sphere, Inflate the pieces.
//   The status counts each piece as a result.
//   If `pieces` is empty, nothing is written.
//   Throws if there are more than 2^24 pieces, or if there are pieces and the
//   pointer to them is null or misaligned.
template <int kDims, typename Scalar = float>
void BoundSegmentPieces(
    const Segment<kDims, Scalar>& segment,
    std::decay_t<Span<Aabo<kDims>>> pieces,  // or a vector of them
    FitStatus* status = nullptr) {
  detail::BoundSegmentPieces(
      detail::ShapeOf<kDims, Scalar>(&segment, pieces.data()), pieces.size(),
      status);
}

// Bounds an axis-aligned box: its X, Y and Z, and the D of its corners.
//   Returns Empty() for an empty box: all minima +inf and all maxima -inf, or
//   FLT_MAX and -FLT_MAX (DBL_MAX and -DBL_MAX for doubles).
//   Throws if min[k] > max[k] in any other box.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundAabb(const Aabb<kDims, Scalar>& box,
                      FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundAabb, &box, status);
}

// Bounds a sphere. Radius 0 is a point. For a body that rotates, bound a sphere
// around its pivot.
//   Throws if the radius is negative or NaN.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundSphere(const Sphere<kDims, Scalar>& sphere,
                        FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundSphere, &sphere, status);
}

// Bounds a capsule, which is a swept sphere. Errors as for BoundSphere.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundCapsule(const Capsule<kDims, Scalar>& capsule,
                         FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundCapsule, &capsule, status);
}

// Bounds an oriented box, or any parallelepiped.
//   Throws if a half-extent is negative or NaN.
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundOrientedBox(const OrientedBox<kDims, Scalar>& box,
                             FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundOrientedBox, &box, status);
}

// Bounds the exact image of a point set, or of a box, under an affine map. Call
// it on the local shape in every pose, instead of rotating a bound, which makes
// it grow. The shape and the map can have different precisions: a map of
// doubles places a local mesh of floats exactly.
//   Errors and special values as for BoundPoints and BoundAabb.
template <int kDims, typename Scalar = float, typename MapScalar = float>
Aabo<kDims> BoundTransformed(const Points<kDims, Scalar>& points,
                             const Affine<kDims, MapScalar>& map,
                             FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundImageOfPoints, &points,
                                      &map, std::is_same_v<MapScalar, double>,
                                      status);
}
template <int kDims, typename Scalar = float, typename MapScalar = float>
Aabo<kDims> BoundTransformed(const Aabb<kDims, Scalar>& box,
                             const Affine<kDims, MapScalar>& map,
                             FitStatus* status = nullptr) {
  return detail::Built<kDims, Scalar>(&detail::BoundImageOfBox, &box, &map,
                                      std::is_same_v<MapScalar, double>,
                                      status);
}

}  // namespace halfspace

#endif  // HALFSPACE_FIT_H_
