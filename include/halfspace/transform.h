// Bounds of bounds: merge, inflate, translate, scale, sweep. Intersection and
// the measures, which need no rounding outward, are in bounds.h.
//
//   // The query for a body that moves by (0, 0, -2) during a time step.
//   const halfspace::Aabo3 swept = halfspace::Sweep(bound, {0, 0, -2});
//
// `Bound` is any of UpSimplex, DownSimplex, Aabb and Aabo of floats in 2, 3 or
// 4 dimensions. Only RoundOutward takes boxes of doubles.
//
// No overlap is ever missed. If the given bounds enclose their shapes, the
// result encloses the exact merged, inflated or moved shape, as for the
// builders of fit.h: no minimum is above and no maximum is below the exact
// value. Merge is exact. All other calls round outward, so a result that is
// transformed again grows by up to 1 ulp per step. Translate the local bound in
// every frame, not the result of the last frame.
//
// Special values, except of RoundOutward:
// - A plane without a limit (a minimum of -FLT_MAX, a maximum of FLT_MAX, as in
//   Everything()) stays so, for all values of the other planes.
// - Empty() stays Empty(). So does a bound with minima of FLT_MAX and maxima of
//   -FLT_MAX on all planes (IsEmpty of bounds.h).
// - If any other value is NaN, infinite or beyond 2^126, or becomes so, the
//   result is Everything().
// `status` can be null. It counts all results that are Everything().
//
// The tightness, "throws", the thread safety and the floating-point mode are as
// in fit.h.
//
// Cost: tens of ns, and about 100 ns for BoundTransformed
// (`./bench.sh --details build`).
//
// Source: "The Bounding Simplex", for the axes. The outward rounding is this
// library's own (docs/exactness.md).
#ifndef HALFSPACE_TRANSFORM_H_
#define HALFSPACE_TRANSFORM_H_

#include <cstddef>
#include <type_traits>
#include <utility>

#include "halfspace/bounds.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"

namespace halfspace {

namespace detail {

template <typename T>
using IfBoundOfFloats =
    std::enable_if_t<std::is_same_v<typename T::Scalar, float>, IfBound<T>>;

// With minima and maxima.
template <typename Bound>
using IfClosed = std::enable_if_t<HasMin<Bound> && HasMax<Bound>>;

// The values of a bound of any type: all minima, then all maxima. The calls
// below replace them.
struct AnyBound {
  float* values;
  std::size_t dims;       // axis `dims` is D
  std::size_t min_count;  // 0, or the number of axes
  std::size_t max_count;
};

HALFSPACE_API void Merge(AnyBound& bound, const float* other,
                         FitStatus* status);
HALFSPACE_API void Inflate(AnyBound& bound, float radius, FitStatus* status);
HALFSPACE_API void InflateByBox(AnyBound& bound, float margin,
                                FitStatus* status);
HALFSPACE_API void Translate(AnyBound& bound, const float* by,
                             FitStatus* status);
HALFSPACE_API void TranslateVertices(AnyBound& bound, const float* by,
                                     FitStatus* status);
HALFSPACE_API void Scale(AnyBound& bound, float factor, FitStatus* status);

// A bound that is returned in registers. Its values are read one by one,
// because a load of two values would wait for the stores of both: 10 % of an
// Inflate().
template <typename Bound, std::size_t... kValue>
Bound ReadBound(const volatile float* values, std::index_sequence<kValue...>) {
  const PlaneValues<Bound> read = {values[kValue]...};
  return BoundOf<Bound>(read);
}

// Returns a copy of the bound that change(copy, argument, status) has changed.
template <typename Bound, typename Argument>
Bound Changed(const Bound& bound,
              void (*change)(AnyBound&, Argument, FitStatus*),
              Argument argument, FitStatus* status) {
  static_assert(Bound::kAxes >= Bound::kDimensions, "slot k is axis k");
  static_assert(std::is_standard_layout_v<Bound> &&
                    sizeof(Bound) == kPlaneCount<Bound> * sizeof(float),
                "a bound is changed as a list of its values");
  Bound result = bound;
  AnyBound any = {reinterpret_cast<float*>(&result), Bound::kDimensions,
                  HasMin<Bound> ? Bound::kAxes : 0,
                  HasMax<Bound> ? Bound::kAxes : 0};
  change(any, argument, status);
  if constexpr (sizeof(Bound) <= 16) {
    return ReadBound<Bound>(reinterpret_cast<const float*>(&result),
                            std::make_index_sequence<kPlaneCount<Bound>>());
  } else {
    return result;
  }
}

}  // namespace detail

// Returns the bound of the union of two shapes, which also bounds its convex
// hull. Exact: nothing is rounded. Merging with Empty() changes nothing.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>>
Bound Merge(const Bound& a, const Bound& b, FitStatus* status = nullptr) {
  return detail::Changed(a, &detail::Merge,
                         detail::RecordsOf(Span<const Bound>(&b, 1)), status);
}

// Inflates a bound by a sphere: the Minkowski sum with a sphere of this radius.
// D moves by sqrt(kDims) times the radius.
//   Throws if `radius` is negative or NaN.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>>
Bound Inflate(const Bound& bound, float radius, FitStatus* status = nullptr) {
  return detail::Changed(bound, &detail::Inflate, radius, status);
}

// Inflates a bound by a cube: every point may move by up to `margin` along each
// coordinate axis. D moves by kDims times the margin.
//   Throws if `margin` is negative or NaN.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>>
Bound InflateByBox(const Bound& bound, float margin,
                   FitStatus* status = nullptr) {
  return detail::Changed(bound, &detail::InflateByBox, margin, status);
}

// Moves the exact set: every point p becomes p + by, without rounding.
//   Vertices that your program moves and rounds to float can lie outside the
//   result. Use TranslateVertices for them.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>>
Bound Translate(const Bound& bound, const Point<Bound::kDimensions>& by,
                FitStatus* status = nullptr) {
  return detail::Changed(bound, &detail::Translate, by.data(), status);
}

// Moves vertices as float arithmetic does. For all float vertices v whose hull
// is inside `bound`, the result encloses the hull of float(v + by), rounded to
// nearest in each coordinate. X, Y and Z are float(min + by) and float(max +
// by). D is widened by as much as rounding can move a vertex: at most 2^-24
// times the sum of the largest coordinates.
//   There is no overload for simplices, because they bound each coordinate on
//   one side only.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>,
          typename = detail::IfClosed<Bound>>
Bound TranslateVertices(const Bound& bound, const Point<Bound::kDimensions>& by,
                        FitStatus* status = nullptr) {
  return detail::Changed(bound, &detail::TranslateVertices, by.data(), status);
}

// Scales the exact set about the origin.
//   A negative factor mirrors the shape, so minima become maxima.
//   Throws if `factor` is NaN, and for a simplex, which has only minima or only
//   maxima, also if it is negative.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>>
Bound Scale(const Bound& bound, float factor, FitStatus* status = nullptr) {
  return detail::Changed(bound, &detail::Scale, factor, status);
}

// Returns the bound of a shape that moves by `motion`, in a straight line and
// without rotation: the hull of the exact start and end.
//   If you have a bound of each of the two poses, Merge them instead. That
//   bounds any motion in which every point stays on the segment between its two
//   positions.
template <typename Bound, typename = detail::IfBoundOfFloats<Bound>>
Bound Sweep(const Bound& bound, const Point<Bound::kDimensions>& motion,
            FitStatus* status = nullptr) {
  return Merge(bound, Translate(bound, motion), status);
}

// Returns the box of floats for a box of doubles: each minimum is rounded down
// and each maximum up.
//   A double that is a float stays equal. NaN and infinities stay. A minimum
//   below -FLT_MAX becomes -infinity, a maximum above FLT_MAX becomes infinity,
//   so Everything() becomes a box without limits. An empty box stays empty.
template <int kDims>
Aabb<kDims> RoundOutward(const Aabb<kDims, double>& box) {
  detail::PlaneValues<Aabb<kDims>> values;
  const Span<const Aabb<kDims, double>> one(&box, 1);
  detail::ReadRecords(detail::ColumnsOf(one), values.size(), kDims, 0, 1,
                      values.data());
  return detail::BoundOf<Aabb<kDims>>(values);
}

}  // namespace halfspace

#endif  // HALFSPACE_TRANSFORM_H_
