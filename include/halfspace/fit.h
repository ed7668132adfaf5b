// Builders: the tightest bounds, in float, that are sure to enclose a shape.
//
// The contract: every finite float or double of the input is taken as an exact
// real number, and the bound that comes back encloses the exact real set those
// numbers describe. A minimum is never above, a maximum never below the exact
// value. Two closed sets that intersect, touching included, are therefore never
// rejected, whichever builder and target made the two bounds.
// docs/exactness.md has the proof.
//
// Every builder returns an Aabo, which serves both sides of a test: take its
// up() for the objects of a simplex world, its down() for the queries, its
// aabb() for a box. Bounds of bounds (merged, inflated, moved, swept) are in
// transform.h, which this header includes; many at once are in fit_many.h.
//
//   a shape                          its builder
//   point, triangle, segment         BoundPoint, BoundTriangle, BoundSegment
//   point set, mesh (indexed)        BoundPoints
//   frustum: corners, or planes      BoundPoints, BoundFrustum
//   axis-aligned box                 BoundAabb
//   oriented box                     BoundOrientedBox
//   sphere, capsule                  BoundSphere, BoundCapsule
//   ray with a maximum distance      BoundRay
//   long segment, in pieces          BoundSegmentPieces
//   affine image of points or a box  BoundTransformed
//   moving body                      Sweep, or Merge of two poses (transform.h)
//   rotating body                    BoundSphere around its pivot
//
// Every builder takes shapes of floats, Segment3, and of doubles, Segment<3,
// double>. Bounds are of floats in both cases, and as tight.
//
// How tight: a value is the tightest float if its exact value is a sum of
// products of inputs. Where a square root or a quotient is involved (sphere,
// capsule, frustum, pieces), it is within 1 ulp of that; each builder says so.
// X, Y and Z of points and boxes of floats are copied.
//
// Limits: the magnitudes of a point's coordinates may sum to at most 2^125, in
// the input's precision and the caller's unit. Finite floats cannot bound what
// lies beyond, or has a NaN or an infinity: the result is then Everything(),
// which never rejects, and the status counts it.
//
// Errors (error.h): only those named below. Thread safety: pure functions.
//
// Floating-point mode: builders work in the default mode and restore the
// caller's. So its rounding, its flushing of subnormals and its traps do not
// matter, and a builder never traps. A builder may raise exception flags and
// clears none. The library is compiled without fast-math and contraction
// whatever the caller's flags are. Cost: tens to hundreds of ns, and 5 ns a
// point; up to twice that of doubles, and four times for pieces and frusta;
// docs/performance.md has a table.
//
// Source: "The Bounding Simplex", for the axes; the outward rounding is this
// library's own (docs/exactness.md).
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

// Bounds the convex hull of a point set: of floats or doubles, as an array of
// structures or a structure of arrays. Empty() if there are no points.
//   Throws if, with count > 0, a pointer is null or misaligned, or the points
//   do not fit the address space.
//   Everything() if a point has a NaN or an infinity, or is too large.
//   Tightest; X, Y, Z of floats are copied.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundPoints(const Points<kDims, Scalar>& points,
                                      FitStatus* status = nullptr);
template <int kDims, typename Scalar>
HALFSPACE_API Aabo<kDims> BoundPoints(const PointsSoa<kDims, Scalar>& points,
                                      FitStatus* status = nullptr);

// The same for those points whose indices are given, in any order; an index may
// repeat. It gives one bound for a triangle mesh, for example.
//   Throws also if an index is not below points.count, or if the pointer to
//   them is null or misaligned.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundPoints(const Points<kDims, Scalar>& points,
                                      Span<const std::uint32_t> indices,
                                      FitStatus* status = nullptr);
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundPoints(const PointsSoa<kDims, Scalar>& points,
                                      Span<const std::uint32_t> indices,
                                      FitStatus* status = nullptr);

// Bounds one point. Tightest. Call as BoundPoint<3>({x, y, z}).
template <int kDims, typename Scalar = float>
Aabo<kDims> BoundPoint(const Point<kDims, Scalar>& point,
                       FitStatus* status = nullptr) {
  return BoundPoints(Points<kDims, Scalar>{point.data(), 1}, status);
}

// Bounds a segment with both ends. Tightest.
//   The longer and the more diagonal a segment is, the worse a single bound
//   fits it: see BoundSegmentPieces.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundSegment(const Segment<kDims, Scalar>& segment,
                                       FitStatus* status = nullptr);

// Bounds a triangle. Tightest.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundTriangle(const Triangle<kDims, Scalar>& triangle,
                                        FitStatus* status = nullptr);

// Bounds a ray up to its maximum distance. Tightest.
//   Throws if max_t is negative or NaN. Everything() if it is infinite: pass
//   the distance at which the world ends.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundRay(const Ray<kDims, Scalar>& ray,
                                   FitStatus* status = nullptr);

// Cuts a segment into pieces.size() equal pieces and bounds each, in order from
// a to b. All pieces together enclose the segment, and neighbours share the
// point where they meet. Test each piece as a query of its own: n pieces of a
// long diagonal segment keep far fewer objects than one bound of the whole
// (docs/exactness.md has figures). For a ray, cut the segment that it covers;
// for a moving sphere, Inflate the pieces.
//   Within 1 ulp. The status counts each piece.
//   No pieces: nothing is written. Throws if there are more than 2^24, or if
//   the pointer to them is null or misaligned.
template <int kDims, typename Scalar = float>
HALFSPACE_API void BoundSegmentPieces(
    const Segment<kDims, Scalar>& segment,
    std::decay_t<Span<Aabo<kDims>>> pieces,  // or a vector of them
    FitStatus* status = nullptr);

// Bounds an axis-aligned box: the same X, Y, Z, and the D of its corners.
//   Tightest. An Empty() box (minima +inf and maxima -inf, or FLT_MAX and
//   -FLT_MAX, of doubles DBL_MAX) gives Empty(). Throws if min[k] > max[k] in
//   any other box.
template <int kDims>
HALFSPACE_API Aabo<kDims> BoundAabb(const Aabb<kDims>& box,
                                    FitStatus* status = nullptr);
template <int kDims, typename Scalar>
HALFSPACE_API Aabo<kDims> BoundAabb(const Box<kDims, Scalar>& box,
                                    FitStatus* status = nullptr);

// Bounds a sphere. Radius 0 is the point.
//   Throws if the radius is negative or NaN.
//   X, Y, Z tightest; D within 1 ulp, or, where it all but cancels, within
//   2^-100 of the radius.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundSphere(const Sphere<kDims, Scalar>& sphere,
                                      FitStatus* status = nullptr);

// Bounds a capsule, a swept sphere. As BoundSphere.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundCapsule(const Capsule<kDims, Scalar>& capsule,
                                       FitStatus* status = nullptr);

// Bounds an oriented box, or any parallelepiped. Tightest.
//   Throws if a half-extent is negative or NaN. Everything() if a number of an
//   axis is beyond 2^900.
template <int kDims, typename Scalar = float>
HALFSPACE_API Aabo<kDims> BoundOrientedBox(
    const OrientedBox<kDims, Scalar>& box, FitStatus* status = nullptr);

// Bounds what lies in front of all six planes of a frustum, or of any convex
// set with up to six faces; planes may repeat. If the eight corners are known,
// pass them to BoundPoints instead.
//   Everything() if the planes do not close a volume; otherwise Empty() if
//   nothing lies in front of all of them.
//   Throws unless there are six planes, or if the pointer to them is null or
//   misaligned.
//   Within 1 ulp. Cost: about 25 us, and up to ten times that where more than
//   three planes meet in a point, or nearly.
//   Of doubles also Everything() if a number of a plane is not 0 and differs
//   from the largest of its normal by a factor of more than 2^200.
HALFSPACE_API Aabo3 BoundFrustum(Span<const HalfSpace3> planes,
                                 FitStatus* status = nullptr);
HALFSPACE_API Aabo3 BoundFrustum(Span<const HalfSpace<3, double>> planes,
                                 FitStatus* status = nullptr);

// Bounds the exact image of a point set, or of a box, under an affine map. Call
// it on the local shape in every pose instead of turning a bound: a bound of a
// turned bound grows. Shape and map may be of floats or doubles, each on its
// own: a map of doubles places a local mesh of floats exactly.
//   Tightest. Errors and special cases as of BoundPoints and BoundAabb; the box
//   is Everything() also if a number of the map's linear part is beyond 2^900.
template <int kDims, typename Scalar = float, typename MapScalar = float>
HALFSPACE_API Aabo<kDims> BoundTransformed(const Points<kDims, Scalar>& points,
                                           const Affine<kDims, MapScalar>& map,
                                           FitStatus* status = nullptr);
template <int kDims, typename MapScalar = float>
HALFSPACE_API Aabo<kDims> BoundTransformed(const Aabb<kDims>& box,
                                           const Affine<kDims, MapScalar>& map,
                                           FitStatus* status = nullptr);
template <int kDims, typename Scalar, typename MapScalar = float>
HALFSPACE_API Aabo<kDims> BoundTransformed(const Box<kDims, Scalar>& box,
                                           const Affine<kDims, MapScalar>& map,
                                           FitStatus* status = nullptr);

}  // namespace halfspace

#endif  // HALFSPACE_FIT_H_
