// Bounds of bounds: merged, inflated, moved, scaled, swept, turned over. What
// needs no rounding, Intersection and measures, is in bounds.h.
//
// `Bound` is any of UpSimplex, DownSimplex, Aabb and Aabo in 2, 3 or 4
// dimensions, of floats: those of doubles are the caller's own (bounds.h), and
// no call takes them. If the bounds given enclose their shapes, the result
// encloses the merged, inflated, moved ... shape, exactly as for the builders
// of fit.h: no minimum is above and no maximum below the exact value, so
// touching shapes are never rejected.
//
// Every call rounds outward, so results of results drift outward, by up to an
// ulp a step. Move from the local bound each time, not from the last result.
//
// Special values, each plane on its own: a plane without a bound (-FLT_MAX as a
// minimum, FLT_MAX as a maximum, as all planes of Everything()) stays so.
// Empty() in, Empty() out, also for minima of FLT_MAX with maxima of -FLT_MAX
// on all planes (IsEmpty of bounds.h). If any other value is NaN, infinite or
// beyond 2^126, or becomes so, the result is Everything(), and the status
// counts it.
//
// Errors: only those named below, thrown as std::invalid_argument. Thread
// safety: pure functions. The caller's floating-point mode and compiler flags
// do not matter, as in fit.h. Cost: tens of ns, up to twice
// that where every bound differs; docs/performance.md has a table.
//
// Source: "The Bounding Simplex", for the axes; docs/exactness.md for the
// rounding.
#ifndef HALFSPACE_TRANSFORM_H_
#define HALFSPACE_TRANSFORM_H_

#include <concepts>

#include "halfspace/bounds.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/shapes.h"

namespace halfspace {

// The bound of two shapes together, and of their convex hull. Exact: rounds
// nothing. Empty() is its identity.
template <typename Bound>
HALFSPACE_API Bound Merge(const Bound& a, const Bound& b,
                          FitStatus* status = nullptr);

// Grows a bound by a sphere: the Minkowski sum with a sphere of this radius. D
// moves by sqrt(kDims) times the radius.
//   Throws if the radius is negative or NaN. X, Y, Z tightest; D within 1 ulp,
//   or, where it all but cancels, within 2^-100 of the radius.
template <typename Bound>
HALFSPACE_API Bound Inflate(const Bound& bound, float radius,
                            FitStatus* status = nullptr);

// Grows a bound by a box: every point may move by up to `margin` along each
// coordinate axis. D moves by kDims times the margin.
//   Throws if the margin is negative or NaN. Tightest.
template <typename Bound>
HALFSPACE_API Bound InflateByBox(const Bound& bound, float margin,
                                 FitStatus* status = nullptr);

// Moves the exact set: every point p becomes the real number p + by, unrounded.
// Tightest.
//   Vertices that are rounded to float after they were moved may lie outside:
//   for them, TranslateVertices.
template <typename Bound>
HALFSPACE_API Bound Translate(const Bound& bound,
                              const Point<Bound::kDimensions>& by,
                              FitStatus* status = nullptr);

// Moves vertices as float arithmetic does: encloses the hull of all
// float(v + by), rounded to nearest in each coordinate, for float vertices v
// whose hull is inside the bound. X, Y, Z are float(min + by) and
// float(max + by); D gives way by what the rounding can move a vertex, at most
// 2^-24 times the sum of the largest coordinates.
//   Simplices bound coordinates on one side only; this takes boxes and AABOs.
template <int kDims>
HALFSPACE_API Aabb<kDims> TranslateVertices(const Aabb<kDims>& bound,
                                            const Point<kDims>& by,
                                            FitStatus* status = nullptr);
template <int kDims>
HALFSPACE_API Aabo<kDims> TranslateVertices(const Aabo<kDims>& bound,
                                            const Point<kDims>& by,
                                            FitStatus* status = nullptr);

// Scales the exact set about the origin. Tightest.
//   A negative factor turns the shape over: minima become maxima. Simplices
//   have no other side, so for them it throws; NaN always throws.
template <typename Bound>
HALFSPACE_API Bound Scale(const Bound& bound, float factor,
                          FitStatus* status = nullptr);

// The bound of a shape all along a straight move by `motion`, which it makes
// without turning: the hull of the exact start and end. Tightest.
//   Where both poses have bounds of their own, Merge them: for any motion in
//   which every point stays on the straight line between its two places.
template <typename Bound>
Bound Sweep(const Bound& bound, const Point<Bound::kDimensions>& motion,
            FitStatus* status = nullptr) {
  return Merge(bound, Translate(bound, motion), status);
}

// The opposing simplex circumscribed about a simplex: what a query has to
// supply when only the object's simplex is stored, and the other way round. It
// is 3 times (in 3D; kDims times) as large, so prefer the Aabo of the shape
// where that is known. Tightest.
//   A simplex that contains no point (whose planes sum to more than 0) throws;
//   Empty() gives Empty().
template <int kDims>
HALFSPACE_API DownSimplex<kDims> Circumscribe(const UpSimplex<kDims>& simplex,
                                              FitStatus* status = nullptr);
template <int kDims>
HALFSPACE_API UpSimplex<kDims> Circumscribe(const DownSimplex<kDims>& simplex,
                                            FitStatus* status = nullptr);

// Bounds of doubles are refused by the compiler, not by the linker.
namespace detail {
template <typename Bound>
concept BoundOfDoubles = std::same_as<typename Bound::Scalar, double>;
}  // namespace detail

template <detail::BoundOfDoubles Bound>
Bound Merge(const Bound& a, const Bound& b,
            FitStatus* status = nullptr) = delete;
template <detail::BoundOfDoubles Bound>
Bound Inflate(const Bound& bound, float radius,
              FitStatus* status = nullptr) = delete;
template <detail::BoundOfDoubles Bound>
Bound InflateByBox(const Bound& bound, float margin,
                   FitStatus* status = nullptr) = delete;
template <detail::BoundOfDoubles Bound>
Bound Translate(const Bound& bound, const Point<Bound::kDimensions>& by,
                FitStatus* status = nullptr) = delete;
template <detail::BoundOfDoubles Bound>
Bound Scale(const Bound& bound, float factor,
            FitStatus* status = nullptr) = delete;
template <detail::BoundOfDoubles Bound>
Bound Sweep(const Bound& bound, const Point<Bound::kDimensions>& motion,
            FitStatus* status = nullptr) = delete;

}  // namespace halfspace

#endif  // HALFSPACE_TRANSFORM_H_
