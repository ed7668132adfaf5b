// Internal. The calls of fit_many.h after the types are gone: the boundary
// between the caller's translation unit and the library. Not part of the
// interface.
#ifndef HALFSPACE_DETAIL_FIT_MANY_H_
#define HALFSPACE_DETAIL_FIT_MANY_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/fit_status.h"
#include "halfspace/planes.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/target.h"

namespace halfspace {

struct FitOptions;

namespace detail {

struct FitKernels;

enum FitSource { kFitBoxes, kFitSpheres, kFitTriangles, kFitPointSets };

// The builders of one source of floats in kDims dimensions, of each compiled
// target, best first: an object file of the library for each, as ScanKernelsOf
// of scan.h. The source is an int, because clang exports no template whose
// arguments have a type that is not exported.
template <int kSource, int kDims>
struct HALFSPACE_API FitKernelsOf {
  static const FitKernels* const kTargets;
};

#define HALFSPACE_DECLARE_KERNELS(source)         \
  extern template struct FitKernelsOf<source, 2>; \
  extern template struct FitKernelsOf<source, 3>; \
  extern template struct FitKernelsOf<source, 4>
HALFSPACE_DECLARE_KERNELS(kFitBoxes);
HALFSPACE_DECLARE_KERNELS(kFitSpheres);
HALFSPACE_DECLARE_KERNELS(kFitTriangles);
HALFSPACE_DECLARE_KERNELS(kFitPointSets);
#undef HALFSPACE_DECLARE_KERNELS

// The builders of doubles by source and by dimensions, from 2 on. There is one
// for all targets.
HALFSPACE_API extern const FitKernels* const kFitOfDoubles[4][3];

// Boxes have all minima, then all maxima; spheres the center, then the radius;
// points their coordinates.
struct Source {
  const FitKernels* kernels;  // of each target
  int dims;
  std::size_t column_count;
  Columns columns;
  bool has_one_pointer;  // for all columns: Points
};

// The builders give floats: planes of doubles are the caller's to fill.
template <typename Planes>
using IfOfFloats =
    std::enable_if_t<std::is_same_v<typename Planes::Scalar, float>>;

// The planes of an Aabo, all minima, then all maxima; those that are not wanted
// are null, and their bit in `wanted` is 0.
struct Output {
  std::size_t size = 0;
  std::uint32_t wanted = 0;
  std::array<float*, kMaxPlanes> planes{};

  constexpr void Want(std::size_t plane, float* memory) {
    wanted |= std::uint32_t{1} << plane;
    planes[plane] = memory;
  }
};

template <FitSource kSource, int kDims, typename Scalar>
Source SourceOf(const Columns& columns, std::size_t column_count,
                bool has_one_pointer = false) {
  static_assert(2 <= kDims && kDims <= 4, "bounds have 2, 3 or 4 dimensions");
  const FitKernels* kernels = nullptr;
  if constexpr (std::is_same_v<Scalar, float>) {
    kernels = FitKernelsOf<kSource, kDims>::kTargets;
  } else {
    kernels = kFitOfDoubles[kSource][kDims - 2];
  }
  return {kernels, kDims, column_count, columns, has_one_pointer};
}

template <FitSource kSource, int kDims, typename Scalar>
Source SourceOf(const Boxes<kDims, Scalar>& boxes) {
  return SourceOf<kSource, kDims, Scalar>(ColumnsOf(boxes), 2 * kDims);
}

template <FitSource kSource, int kDims, typename Scalar>
Source SourceOf(const Spheres<kDims, Scalar>& spheres) {
  Columns columns = ColumnsOf<Scalar>(spheres.count, spheres.stride);
  for (std::size_t k = 0; k < kDims; ++k) {
    columns.column[k] = spheres.center[k];
  }
  columns.column[kDims] = spheres.radius;
  return SourceOf<kSource, kDims, Scalar>(columns, kDims + 1);
}

template <FitSource kSource, int kDims, typename Scalar>
Source SourceOf(const Points<kDims, Scalar>& points) {
  Columns columns = ColumnsOf<Scalar>(points.count, points.stride);
  for (std::size_t k = 0; k < kDims; ++k) {
    columns.column[k] = points.coords == nullptr ? nullptr : points.coords + k;
  }
  return SourceOf<kSource, kDims, Scalar>(columns, kDims, true);
}

template <FitSource kSource, int kDims, typename Scalar>
Source SourceOf(const PointsSoa<kDims, Scalar>& points) {
  Columns columns = ColumnsOf<Scalar>(points.count, 1);
  for (std::size_t k = 0; k < kDims; ++k) columns.column[k] = points.coords[k];
  return SourceOf<kSource, kDims, Scalar>(columns, kDims);
}

// Where plane `p` of a type of bound with `axes` axes is in Output::planes.
constexpr std::size_t OutputPlane(std::size_t dims, std::size_t axes,
                                  std::size_t p) {
  return p < axes ? p : p - axes + dims + 1;
}

// Simplex, AABB and AABO planes: those that the type has.
template <typename Planes>
constexpr Output OutputOf(const Planes& planes) {
  constexpr std::size_t kAxes = std::tuple_size_v<decltype(planes.min)>;
  static_assert(kAxes >= Planes::kDimensions,
                "slot k of min and max is axis k: X, Y, ..., D");
  Output output;
  output.size = planes.size;
  for (std::size_t k = 0; k < kAxes; ++k) {
    output.Want(k, planes.min[k]);
    if constexpr (HasMax<Planes>) {
      output.Want(OutputPlane(Planes::kDimensions, kAxes, kAxes + k),
                  planes.max[k]);
    }
  }
  return output;
}

template <int kDims>
constexpr Output OutputOf(const DPlanes<kDims>& planes) {
  Output output;
  output.size = planes.size;
  output.Want(kDims, planes.min);
  output.Want(2 * kDims + 1, planes.max);
  return output;
}

HALFSPACE_API Target BoundBoxes(const Source& boxes, const Output& output,
                                const FitOptions& options, FitStatus* status);
HALFSPACE_API Target BoundSpheres(const Source& spheres, const Output& output,
                                  const FitOptions& options, FitStatus* status);
HALFSPACE_API Target BoundTriangles(const Source& vertices,
                                    Span<const std::uint32_t> indices,
                                    const Output& output,
                                    const FitOptions& options,
                                    FitStatus* status);
HALFSPACE_API Target BoundPointSets(const Source& points,
                                    Span<const std::size_t> ends,
                                    const Output& output,
                                    const FitOptions& options,
                                    FitStatus* status);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_FIT_MANY_H_
