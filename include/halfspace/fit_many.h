// Builders of many bounds at once: N boxes, spheres, triangles or point sets
// into the planes of a world, in SIMD, on the same targets as the tests.
//
// They keep the contract of fit.h: every bound encloses the exact real shape
// that its input describes. X, Y, Z are those of fit.h. D is within 1 ulp of
// the tightest float, or is that float with FitOptions::tightest; for spheres
// see BoundSpheres. Answers are bit-identical on every target and compiler.
//
//   auto world = halfspace::AaboWorld3();
//   world.Resize(boxes.count);
//   halfspace::BoundBoxes(boxes, world.planes());
//
// Every call takes
//   source   the shapes, in the caller's memory (below): of floats, or of
//            doubles, Boxes<3, double>
//   planes   where the bounds are written: planes of floats that the caller
//            owns, or the planes() of an owning world. Their type says which
//            planes are computed: SimplexPlanes, AabbPlanes, AaboPlanes, or
//            DPlanes, the D axis alone, which completes the planes of an AABB
//            world to those of an AABO world. planes.size must be the number of
//            shapes. (Bounds of doubles are computed by the caller: bounds.h.)
//   options  tightness, inverted boxes, target; the defaults are right
//   status   counts, over all calls it is passed to, the shapes that became
//            Everything(), and records the first
// and returns the target that ran.
//
// Bad elements never throw: a shape with a NaN, an infinity, a negative radius,
// an index out of range, an inverted box, or a sum of magnitudes beyond 2^125
// becomes Everything(), which never rejects, and is counted.
//
// Doubles are bounded one after the other, by the builders of fit.h: all axes
// are rounded outward, D is as tight as there on every target, and a bound
// costs what it costs there. The target that is returned is that of the
// options, as for floats, though all run the same code.
//
// Errors (error.h), before anything is written: with N > 0, a pointer is null
// or misaligned, sizes differ or overflow the address space, an output overlaps
// an input or another output, an option is not one of the enumerators, or the
// target is not supported here. N = 0 is valid.
//
// Thread safety: reentrant; no allocation, no lock, no state. Two threads may
// build disjoint parts of one world. The caller's floating-point mode does not
// matter, as in fit.h. Cost: for data larger than the caches, about that of the
// memory (docs/results.md has figures).
//
// Source: "The Bounding Simplex", for the axes; docs/exactness.md for the
// rounding.
#ifndef HALFSPACE_FIT_MANY_H_
#define HALFSPACE_FIT_MANY_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>

#include "halfspace/bounds.h"
#include "halfspace/detail/bulk.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/planes.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"

namespace halfspace {

// What a box with min[k] > max[k] becomes. A box with all minima +inf or
// FLT_MAX and all maxima -inf or -FLT_MAX becomes Empty() in any case.
enum class Inverted : std::uint8_t {
  kEverything,  // a mistake: never rejected, and counted
  kEmpty,       // a box without points: always rejected, not counted
};

struct FitOptions {
  bool tightest = false;  // D is the tightest float, not just within 1 ulp
  Inverted inverted = Inverted::kEverything;
  Target target = {};  // the chosen target
};

namespace detail {
template <int kDims, typename T>
Boxes<kDims, T> BoxesOfRecords(const Aabb<kDims, T>* boxes, std::size_t count) {
  static_assert(sizeof(Aabb<kDims, T>) == 2 * kDims * sizeof(T));
  Boxes<kDims, T> columns;
  columns.count = count;
  columns.stride = 2 * kDims;
  if (boxes == nullptr || count == 0) return columns;
  for (std::size_t k = 0; k < kDims; ++k) {
    columns.min[k] = boxes->min.data() + k;
    columns.max[k] = boxes->max.data() + k;
  }
  return columns;
}
}  // namespace detail

// The boxes of an array of structures.
template <int kDims>
Boxes<kDims> BoxesOf(Span<const Aabb<kDims>> boxes) {
  return detail::BoxesOfRecords(boxes.data(), boxes.size());
}
template <int kDims>
Boxes<kDims, double> BoxesOf(Span<const Aabb<kDims, double>> boxes) {
  return detail::BoxesOfRecords(boxes.data(), boxes.size());
}
template <typename List, typename Box = std::remove_reference_t<
                             decltype(*std::data(std::declval<const List&>()))>>
Boxes<Box::kDimensions, typename Box::Scalar> BoxesOf(const List& boxes) {
  return detail::BoxesOfRecords(std::data(boxes), std::size(boxes));
}

// The boxes of a world: an AabbWorld or its view, or the aabb() of an AaboView.
template <int kDims, typename T>
Boxes<kDims, T> BoxesOf(const AabbView<kDims, T>& view) {
  return {view.min, view.max, view.size, 1};
}
template <int kDims, typename T>
Boxes<kDims, T> BoxesOf(const World<AabbView<kDims, T>>& world) {
  return BoxesOf(world.view());
}

// Bounds boxes. X, Y, Z of floats are copied.
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundBoxes(const Boxes<Planes::kDimensions, Scalar>& boxes,
                  const Planes& planes, const FitOptions& options = {},
                  FitStatus* status = nullptr) {
  return detail::BoundBoxes(detail::SourceOf<detail::kFitBoxes>(boxes),
                            detail::OutputOf(planes), options, status);
}

// Bounds spheres. X, Y, Z are tightest. D is the tightest float for a value
// whose error is less than 2^-49 of |x| + |y| + ... + sqrt(kDims) * radius, or,
// with `tightest`, less than 2^-100 of the radius. So D is within 1 ulp plus
// that error of the tightest float; the error is more than an ulp only where D
// all but cancels. Of doubles as BoundSphere.
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundSpheres(const Spheres<Planes::kDimensions, Scalar>& spheres,
                    const Planes& planes, const FitOptions& options = {},
                    FitStatus* status = nullptr) {
  return detail::BoundSpheres(detail::SourceOf<detail::kFitSpheres>(spheres),
                              detail::OutputOf(planes), options, status);
}

// Bounds the triangles of a mesh, one bound for each: triangle i has the
// vertices indices[3 * i], indices[3 * i + 1] and indices[3 * i + 2].
//   Throws also if indices.size() is not 3 * planes.size. An index that is not
//   below vertices.count makes its triangle Everything().
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundTriangles(const Points<Planes::kDimensions, Scalar>& vertices,
                      Span<const std::uint32_t> indices, const Planes& planes,
                      const FitOptions& options = {},
                      FitStatus* status = nullptr) {
  return detail::BoundTriangles(
      detail::SourceOf<detail::kFitTriangles>(vertices), indices,
      detail::OutputOf(planes), options, status);
}
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundTriangles(const PointsSoa<Planes::kDimensions, Scalar>& vertices,
                      Span<const std::uint32_t> indices, const Planes& planes,
                      const FitOptions& options = {},
                      FitStatus* status = nullptr) {
  return detail::BoundTriangles(
      detail::SourceOf<detail::kFitTriangles>(vertices), indices,
      detail::OutputOf(planes), options, status);
}

// Bounds the convex hulls of consecutive parts of a point array: set i holds
// the points ends[i - 1] .. ends[i] - 1, the first one from point 0.
//   ends.size() is planes.size. An empty set gives Empty(). A set that ends
//   before it begins, or past points.count, becomes Everything().
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundPointSets(const Points<Planes::kDimensions, Scalar>& points,
                      Span<const std::size_t> ends, const Planes& planes,
                      const FitOptions& options = {},
                      FitStatus* status = nullptr) {
  return detail::BoundPointSets(detail::SourceOf<detail::kFitPointSets>(points),
                                ends, detail::OutputOf(planes), options,
                                status);
}
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundPointSets(const PointsSoa<Planes::kDimensions, Scalar>& points,
                      Span<const std::size_t> ends, const Planes& planes,
                      const FitOptions& options = {},
                      FitStatus* status = nullptr) {
  return detail::BoundPointSets(detail::SourceOf<detail::kFitPointSets>(points),
                                ends, detail::OutputOf(planes), options,
                                status);
}

}  // namespace halfspace

#endif  // HALFSPACE_FIT_MANY_H_
