// hs_bound_...(): bounds of shapes, as records.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <type_traits>

#include "c/call.h"
#include "c/columns.h"
#include "halfspace/fit_many.h"

namespace halfspace::c {
namespace {

constexpr hs_bound_options kBoundDefaults = {sizeof(hs_bound_options), 0,
                                             nullptr};

// What is bounded at a time: its planes stay in the cache.
constexpr std::size_t kMostShapes = 256;

template <detail::FitSource kSource>
detail::Source SourceOf(std::size_t dims, const detail::Columns& columns,
                        std::size_t column_count,
                        bool has_one_pointer = false) {
  const auto make = [&]<int kDims>(std::integral_constant<int, kDims>) {
    return columns.is_double ? detail::SourceOf<kSource, kDims, double>(
                                   columns, column_count, has_one_pointer)
                             : detail::SourceOf<kSource, kDims, float>(
                                   columns, column_count, has_one_pointer);
  };
  return dims == 2 ? make(std::integral_constant<int, 2>())
                   : make(std::integral_constant<int, 3>());
}

// Records begin ... begin + count - 1 of some columns.
template <detail::FitSource kSource>
detail::Source SourceOf(std::size_t dims, const hs_columns& columns,
                        const Values& values, std::size_t begin,
                        std::size_t count, bool has_one_pointer = false) {
  detail::Columns some = ColumnsOf(columns, values);
  some.size = count;
  some.stride = columns.stride;
  for (std::size_t v = 0; v < values.count; ++v) {
    some.column[v] = static_cast<const char*>(some.column[v]) +
                     begin * some.stride * some.scalar_bytes();
  }
  return SourceOf<kSource>(dims, some, values.count, has_one_pointer);
}

// One call: its arguments, and the records that it writes.
class Bounder {
 public:
  Bounder(const Call& call, hs_kind kind, const hs_bound_options* options,
          float* bounds, std::size_t count, std::size_t* everything)
      : layout_(LayoutOf(call, "kind", kind)),
        bounds_(bounds),
        count_(count),
        everything_(everything) {
    const hs_bound_options read =
        ReadOptions(call, "options", options, kBoundDefaults);
    options_.inverted =
        read.empty_if_inverted != 0 ? Inverted::kEmpty : Inverted::kEverything;
    options_.target = ReadTarget(call, "options", read.target);
    call.CheckArray("bounds", bounds, count);
    if (everything != nullptr) call.CheckPointer("everything", everything);
    if (count > PTRDIFF_MAX / (kMostValues * sizeof(float))) {
      call.Fail(HS_INVALID_ARGUMENT, "bounds",
                "expected records that fit the address space, got %zu", count);
    }
  }

  std::size_t dims() const { return layout_.dims; }

  // Calls fit(begin, count, output, options, status) for some shapes at a time,
  // and writes the bounds that are in `output` then.
  template <typename Fit>
  void Run(const Fit& fit) const {
    FitStatus status;
    std::array<float, kMostShapes * kMostValues> planes;
    const std::size_t values = RecordValues(layout_);
    for (std::size_t begin = 0; begin < count_; begin += kMostShapes) {
      const std::size_t count = std::min(count_ - begin, kMostShapes);
      detail::Output output;
      output.size = count;
      for (std::size_t v = 0; v < values; ++v) {
        output.Want(detail::OutputPlane(layout_.dims, layout_.axes, v),
                    planes.data() + v * kMostShapes);
      }
      fit(begin, count, output, options_, status);
      float* to = bounds_ + begin * values;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t v = 0; v < values; ++v) {
          *to++ = planes[v * kMostShapes + i];
        }
      }
    }
    if (everything_ != nullptr) *everything_ = status.everything;
  }

 private:
  PlaneLayout layout_;
  float* bounds_;
  std::size_t count_;
  std::size_t* everything_;
  FitOptions options_;
};

constexpr std::size_t kCorners = 3;

// Copies the corners of some triangles at a time, and bounds them as a mesh in
// which no two share a corner.
template <typename Scalar>
void BoundTriangles(const Bounder& bounder, const hs_columns& triangles) {
  const std::size_t dims = bounder.dims();
  std::array<std::uint32_t, kMostShapes * kCorners> indices;
  std::iota(indices.begin(), indices.end(), 0u);
  std::array<Scalar, kMostShapes * kCorners * 3> corners;
  bounder.Run([&](std::size_t begin, std::size_t count,
                  const detail::Output& output, const FitOptions& options,
                  FitStatus& status) {
    const std::size_t values = kCorners * dims;
    for (std::size_t v = 0; v < values; ++v) {
      const Scalar* const column =
          static_cast<const Scalar*>(triangles.column[v]) +
          begin * triangles.stride;
      for (std::size_t i = 0; i < count; ++i) {
        corners[i * values + v] = column[i * triangles.stride];
      }
    }
    detail::BoundTriangles(
        SourceOf<detail::kFitTriangles>(
            dims, detail::ColumnsOfRows(corners.data(), count * kCorners, dims),
            dims, true),
        {indices.data(), count * kCorners}, output, options, &status);
  });
}

}  // namespace
}  // namespace halfspace::c

using halfspace::FitOptions;
using halfspace::FitStatus;
using halfspace::c::Bounder;
using halfspace::c::Call;
using halfspace::c::CheckColumns;
using halfspace::c::LayoutOf;
using halfspace::c::Run;
using halfspace::c::SourceOf;
using halfspace::c::Values;
namespace detail = halfspace::detail;

HALFSPACE_DEFAULTS_OF(hs_bound_options, kBoundDefaults)

hs_status hs_bound_boxes(hs_kind kind, const hs_columns* boxes,
                         const hs_bound_options* options, float* bounds,
                         size_t* everything) {
  return Run("hs_bound_boxes", [&](const Call& call) {
    const Values values =
        Values::OfColumns(2 * LayoutOf(call, "kind", kind).dims);
    CheckColumns(call, "boxes", boxes, values);
    const Bounder bounder(call, kind, options, bounds, boxes->count,
                          everything);
    bounder.Run([&](size_t begin, size_t count, const detail::Output& output,
                    const FitOptions& fit, FitStatus& status) {
      detail::BoundBoxes(SourceOf<detail::kFitBoxes>(bounder.dims(), *boxes,
                                                     values, begin, count),
                         output, fit, &status);
    });
  });
}

hs_status hs_bound_spheres(hs_kind kind, const hs_columns* spheres,
                           const hs_bound_options* options, float* bounds,
                           size_t* everything) {
  return Run("hs_bound_spheres", [&](const Call& call) {
    const Values values =
        Values::OfColumns(LayoutOf(call, "kind", kind).dims + 1);
    CheckColumns(call, "spheres", spheres, values);
    const Bounder bounder(call, kind, options, bounds, spheres->count,
                          everything);
    bounder.Run([&](size_t begin, size_t count, const detail::Output& output,
                    const FitOptions& fit, FitStatus& status) {
      detail::BoundSpheres(SourceOf<detail::kFitSpheres>(
                               bounder.dims(), *spheres, values, begin, count),
                           output, fit, &status);
    });
  });
}

hs_status hs_bound_points(hs_kind kind, const hs_columns* points,
                          const hs_bound_options* options, float* bounds,
                          size_t* everything) {
  return Run("hs_bound_points", [&](const Call& call) {
    const size_t dims = LayoutOf(call, "kind", kind).dims;
    CheckColumns(call, "points", points, 0, dims);
    const Values values = Values::OfPoints(dims);
    const Bounder bounder(call, kind, options, bounds, points->count,
                          everything);
    bounder.Run([&](size_t begin, size_t count, const detail::Output& output,
                    const FitOptions& fit, FitStatus& status) {
      detail::BoundBoxes(
          SourceOf<detail::kFitBoxes>(dims, *points, values, begin, count),
          output, fit, &status);
    });
  });
}

hs_status hs_bound_point_sets(hs_kind kind, const hs_columns* points,
                              const size_t* ends, size_t sets,
                              const hs_bound_options* options, float* bounds,
                              size_t* everything) {
  return Run("hs_bound_point_sets", [&](const Call& call) {
    const size_t dims = LayoutOf(call, "kind", kind).dims;
    CheckColumns(call, "points", points, 0, dims);
    call.CheckArray("ends", ends, sets);
    const Bounder bounder(call, kind, options, bounds, sets, everything);
    const size_t bytes =
        points->type == HS_FLOAT64 ? sizeof(double) : sizeof(float);
    bool is_adjacent = true;
    for (size_t k = 1; k < dims && points->count != 0; ++k) {
      is_adjacent &= points->column[k] ==
                     static_cast<const char*>(points->column[0]) + k * bytes;
    }
    if (!is_adjacent && points->stride != 1) {
      call.Fail(HS_UNSUPPORTED, "points",
                "expected adjacent coordinates or a stride of 1, got "
                "columns apart with a stride of %zu: copy the points",
                points->stride);
    }
    const Values values = Values::OfColumns(dims);
    bounder.Run([&](size_t begin, size_t count, const detail::Output& output,
                    const FitOptions& fit, FitStatus& status) {
      std::array<size_t, halfspace::c::kMostShapes> its_ends;
      for (size_t i = 0, j = 0; i < count; i = j) {
        // Sets i ... j - 1 are bounded at once: those that follow each
        // other, or a bad one alone.
        const size_t first = begin + i == 0 ? 0 : ends[begin + i - 1];
        size_t end = first;
        for (; j < count; ++j) {
          const size_t next = ends[begin + j];
          if (next < end || next > points->count) break;
          its_ends[j - i] = next - first;
          end = next;
        }
        const bool is_bad = j == i;
        if (is_bad) its_ends[j++ - i] = SIZE_MAX;
        const size_t skipped = is_bad ? 0 : first;
        const detail::Source source = SourceOf<detail::kFitPointSets>(
            dims, *points, values, skipped, points->count - skipped,
            is_adjacent);
        detail::Output some = output;
        some.size = j - i;
        for (float*& plane : some.planes) {
          if (plane != nullptr) plane += i;
        }
        detail::BoundPointSets(source, {its_ends.data(), some.size}, some, fit,
                               &status);
      }
    });
  });
}

hs_status hs_bound_triangles(hs_kind kind, const hs_columns* triangles,
                             const hs_bound_options* options, float* bounds,
                             size_t* everything) {
  return Run("hs_bound_triangles", [&](const Call& call) {
    const size_t dims = LayoutOf(call, "kind", kind).dims;
    CheckColumns(call, "triangles", triangles, 0,
                 halfspace::c::kCorners * dims);
    const Bounder bounder(call, kind, options, bounds, triangles->count,
                          everything);
    if (triangles->type == HS_FLOAT64) {
      halfspace::c::BoundTriangles<double>(bounder, *triangles);
    } else {
      halfspace::c::BoundTriangles<float>(bounder, *triangles);
    }
  });
}

hs_status hs_bound_faces(hs_kind kind, const hs_columns* vertices,
                         const uint32_t* indices, size_t faces,
                         const hs_bound_options* options, float* bounds,
                         size_t* everything) {
  return Run("hs_bound_faces", [&](const Call& call) {
    const size_t dims = LayoutOf(call, "kind", kind).dims;
    CheckColumns(call, "vertices", vertices, 0, dims);
    const Bounder bounder(call, kind, options, bounds, faces, everything);
    call.CheckArray("indices", indices, halfspace::c::kCorners * faces);
    const Values values = Values::OfColumns(dims);
    bounder.Run([&](size_t begin, size_t count, const detail::Output& output,
                    const FitOptions& fit, FitStatus& status) {
      const size_t corners = halfspace::c::kCorners;
      detail::BoundTriangles(SourceOf<detail::kFitTriangles>(
                                 dims, *vertices, values, 0, vertices->count),
                             {indices + begin * corners, count * corners},
                             output, fit, &status);
    });
  });
}
