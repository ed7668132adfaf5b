// Bounds of bounds: merged, inflated, moved, scaled, swept, turned over. What
// needs no rounding, Intersection and measures, is in bounds.h.
//
// `Bound` is any of UpSimplex, DownSimplex, Aabb and Aabo in 2, 3 or 4
// dimensions, of floats; no call takes bounds of doubles (bounds.h). If the
// bounds given enclose their shapes, the result encloses the merged, inflated,
// moved ... shape, exactly as for the builders of fit.h: no minimum is above
// and no maximum below the exact value, so touching shapes are never rejected.
//
// Every call rounds outward, so a result that is transformed again grows by up
// to an ulp each time. Move from the local bound each time, not from the last
// result.
//
// Special values: a plane without a bound (-FLT_MAX as a minimum, FLT_MAX as a
// maximum, as all planes of Everything()) stays so, whatever the other planes
// are. Empty() gives Empty(), also minima of FLT_MAX with maxima of -FLT_MAX on
// all planes (IsEmpty of bounds.h). If any other value is NaN, infinite or
// beyond 2^126, or becomes so, the result is Everything(), and the status
// counts it.
//
// Errors (error.h): only those named below. Thread safety: pure functions. The
// caller's floating-point mode and compiler flags do not matter, as in fit.h.
// Cost: tens of ns, and up to twice that where every call has another bound and
// branches are mispredicted; docs/performance.md has a table.
//
// Source: "The Bounding Simplex", for the axes; docs/exactness.md for the
// rounding.
#ifndef HALFSPACE_TRANSFORM_H_
#define HALFSPACE_TRANSFORM_H_

#include "halfspace/bounds.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/shapes.h"

namespace halfspace {

// The bound of the union of two shapes, and of its convex hull. Exact: nothing
// is rounded. Merging with Empty() changes nothing.
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
// float(max + by). D is widened by as much as rounding can move a vertex, at
// most 2^-24 times the sum of the largest coordinates.
//   Takes boxes and AABOs only, because simplices bound each coordinate on one
//   side.
template <int kDims>
HALFSPACE_API Aabb<kDims> TranslateVertices(const Aabb<kDims>& bound,
                                            const Point<kDims>& by,
                                            FitStatus* status = nullptr);
template <int kDims>
HALFSPACE_API Aabo<kDims> TranslateVertices(const Aabo<kDims>& bound,
                                            const Point<kDims>& by,
                                            FitStatus* status = nullptr);

// Scales the exact set about the origin. Tightest.
//   A negative factor turns the shape over: minima become maxima. A simplex has
//   only one of them, so there it throws. NaN always throws.
template <typename Bound>
HALFSPACE_API Bound Scale(const Bound& bound, float factor,
                          FitStatus* status = nullptr);

// The bound of everything that a shape passes while it moves by `motion`, in a
// straight line and without turning: the hull of the exact start and end.
// Tightest.
//   If both poses have bounds of their own, Merge them. That bounds any motion
//   in which every point stays on the segment between its two places.
template <typename Bound>
Bound Sweep(const Bound& bound, const Point<Bound::kDimensions>& motion,
            FitStatus* status = nullptr) {
  return Merge(bound, Translate(bound, motion), status);
}

// The opposing simplex, circumscribed about the given one: it makes a query
// from the simplex that a world stores, or an object from a query. It is kDims
// times as large (3 times in 3D), so use the Aabo of the shape if you have it.
// Tightest.
//   Throws if the simplex contains no point (its planes sum to more than 0).
//   Empty() gives Empty().
template <int kDims>
HALFSPACE_API DownSimplex<kDims> Circumscribe(const UpSimplex<kDims>& simplex,
                                              FitStatus* status = nullptr);
template <int kDims>
HALFSPACE_API UpSimplex<kDims> Circumscribe(const DownSimplex<kDims>& simplex,
                                            FitStatus* status = nullptr);

// Bounds of doubles are refused by the compiler, not by the linker.
template <template <int, typename> class Bound, int kDims>
Bound<kDims, double> Merge(const Bound<kDims, double>& a,
                           const Bound<kDims, double>& b,
                           FitStatus* status = nullptr) = delete;
template <template <int, typename> class Bound, int kDims>
Bound<kDims, double> Inflate(const Bound<kDims, double>& bound, float radius,
                             FitStatus* status = nullptr) = delete;
template <template <int, typename> class Bound, int kDims>
Bound<kDims, double> InflateByBox(const Bound<kDims, double>& bound,
                                  float margin,
                                  FitStatus* status = nullptr) = delete;
template <template <int, typename> class Bound, int kDims>
Bound<kDims, double> Translate(const Bound<kDims, double>& bound,
                               const Point<kDims>& by,
                               FitStatus* status = nullptr) = delete;
template <template <int, typename> class Bound, int kDims>
Bound<kDims, double> Scale(const Bound<kDims, double>& bound, float factor,
                           FitStatus* status = nullptr) = delete;
template <template <int, typename> class Bound, int kDims>
Bound<kDims, double> Sweep(const Bound<kDims, double>& bound,
                           const Point<kDims>& motion,
                           FitStatus* status = nullptr) = delete;

}  // namespace halfspace

#endif  // HALFSPACE_TRANSFORM_H_
