// Builders of many bounds: boxes, spheres, triangles or point sets into the
// planes of a world, in SIMD, on the same targets as the rejection tests.
//
//   halfspace::AaboWorld3 world;
//   world.Resize(boxes.count);
//   halfspace::BoundBoxes(boxes, world.planes());
//
// Every call takes
//   source   the shapes, in the caller's memory: of floats, or of doubles, as
//            in Boxes<3, double>
//   planes   where to write the bounds: the planes() of an owning world of
//            floats, or planes in the caller's memory (planes.h). The type says
//            which planes are computed: SimplexPlanes, AabbPlanes, AaboPlanes,
//            or DPlanes, the D axis alone, which completes the planes of boxes
//            to those of AABOs. `planes.size` must be the number of shapes.
//   options  inverted boxes, target; the defaults are right
//   status   can be null; counts all shapes as results, and those that became
//            Everything() (fit_status.h)
// and returns the target that ran.
//
// No overlap is ever missed, and bounds are as tight as fit.h says. Results are
// bit-identical on every target and compiler.
//
// A bad element never throws. It becomes Everything() and is counted: a shape
// with a NaN, an infinity, a negative radius, an index out of range, magnitudes
// that sum to more than 2^125, or, by default, min[k] > max[k].
//
// Errors (error.h): sizes do not match, an option is not one of the
// enumerators, or the target is not supported; and, if there are shapes, a
// pointer is null or misaligned, the sizes overflow the address space, or an
// output overlaps an input or another output. Nothing is written then.
//
// Thread safety: reentrant. No allocation, no lock, no state. Two threads can
// build disjoint ranges of one world. Floating-point mode: as in fit.h.
//
// Cost: `./bench.sh --details build` prints it. If the data is larger than the
// caches, boxes take about as long as a copy of their bytes (AVX-512), other
// shapes longer. Doubles are bounded one by one, at the cost and with the
// values of fit.h on every target.
//
// Source: "The Bounding Simplex", for the axes; docs/exactness.md, for the
// rounding.
#ifndef HALFSPACE_FIT_MANY_H_
#define HALFSPACE_FIT_MANY_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/bounds.h"
#include "halfspace/detail/fit_many.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/planes.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/target.h"
#include "halfspace/world.h"

namespace halfspace {

// The result for a box with min[k] > max[k] for any k. A box with all minima
// +inf or FLT_MAX and all maxima -inf or -FLT_MAX always becomes Empty(). For
// doubles it is DBL_MAX.
enum class Inverted : std::uint8_t {
  kEverything,  // such a box is a mistake: Everything(), and counted
  kEmpty,       // such a box contains no point: Empty(), and not counted
};

// Options of the builders of many bounds.
struct FitOptions {
  Inverted inverted = Inverted::kEverything;
  Target target = {};  // by default, the chosen one (targets.h)
};

namespace detail {
template <int kDims, typename T>
Boxes<kDims, T> BoxesOfRecords(const Aabb<kDims, T>* boxes, std::size_t count) {
  static_assert(sizeof(Aabb<kDims, T>) == 2 * kDims * sizeof(T));
  Boxes<kDims, T> columns;
  columns.count = count;
  columns.stride = 2 * kDims;
  if (boxes == nullptr || count == 0) return columns;
  // No member is touched: the builder checks the alignment.
  const T* const values = reinterpret_cast<const T*>(boxes);
  for (std::size_t k = 0; k < kDims; ++k) {
    columns.min[k] = values + k;
    columns.max[k] = values + kDims + k;
  }
  return columns;
}
}  // namespace detail

// Returns the boxes of an array of structures. Nothing is copied.
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

// Returns the boxes of a world: of an AabbWorld, its view, or the aabb() of an
// AaboView. Nothing is copied.
template <int kDims, typename T>
Boxes<kDims, T> BoxesOf(const AabbView<kDims, T>& view) {
  return {view.min, view.max, view.size, 1};
}
template <int kDims, typename T>
Boxes<kDims, T> BoxesOf(const World<AabbView<kDims, T>>& world) {
  return BoxesOf(world.view());
}

// Bounds boxes. X, Y and Z of floats are copied.
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundBoxes(const Boxes<Planes::kDimensions, Scalar>& boxes,
                  const Planes& planes, const FitOptions& options = {},
                  FitStatus* status = nullptr) {
  return detail::BoundBoxes(detail::SourceOf<detail::kFitBoxes>(boxes),
                            detail::OutputOf(planes), options, status);
}

// Bounds spheres.
template <typename Planes, typename Scalar = float,
          typename = detail::IfOfFloats<Planes>>
Target BoundSpheres(const Spheres<Planes::kDimensions, Scalar>& spheres,
                    const Planes& planes, const FitOptions& options = {},
                    FitStatus* status = nullptr) {
  return detail::BoundSpheres(detail::SourceOf<detail::kFitSpheres>(spheres),
                              detail::OutputOf(planes), options, status);
}

// Bounds each triangle of a mesh. Triangle i has the vertices indices[3 * i],
// indices[3 * i + 1] and indices[3 * i + 2].
//   `indices.size()` must be `3 * planes.size`.
//   A triangle with an index that is not below `vertices.count` becomes
//   Everything().
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

// Bounds the convex hulls of consecutive ranges of a point array. Set i has the
// points ends[i - 1] ... ends[i] - 1; set 0 begins at point 0.
//   `ends.size()` must be `planes.size`.
//   A set without points becomes Empty(). A set that ends before it begins, or
//   after `points.count`, becomes Everything().
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
