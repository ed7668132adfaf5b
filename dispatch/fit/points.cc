// Hulls of points: sets, segments, triangles.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/exact/exact_bound.h"
#include "dispatch/fit/instantiate.h"
#include "dispatch/fit/point_sources.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::Build;
using dispatch::CanBeBounded;
using dispatch::ExactRanges;
using dispatch::PointAt;
using dispatch::ThrowInvalid;

// The arithmetic, for checked arguments and in the default mode: the hull of
// at(0), at(1), ..., Empty() if there are none. Nothing if a point cannot be
// bounded.
template <int kDims, typename AtIndex>
std::optional<Aabo<kDims>> TryHull(std::size_t count, const AtIndex& at) {
  ExactRanges<kDims> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    const auto point = at(i);
    if (!CanBeBounded(point)) return std::nullopt;
    ranges.AddPoint(point);
  }
  return ranges.Bound();
}

template <int kDims, typename Source>
Aabo<kDims> BoundHull(const Source& points, FitStatus* status) {
  if (points.count != 0) dispatch::CheckPoints("BoundPoints", points);
  return Build(status, [&] {
    return TryHull<kDims>(points.count,
                          [&](std::size_t i) { return PointAt(points, i); });
  });
}

template <int kDims, typename Source>
Aabo<kDims> BoundIndexed(const Source& points,
                         Span<const std::uint32_t> indices, FitStatus* status) {
  if (!indices.empty()) {
    dispatch::CheckPointer(
        "BoundPoints", indices.data(), alignof(std::uint32_t),
        [] { return "indices"; },
        [&] { return std::to_string(indices.size()) + " indices"; });
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= points.count) {
      ThrowInvalid(
          "BoundPoints", "indices[" + std::to_string(i) + "]",
          "less than the number of points, " + std::to_string(points.count),
          std::to_string(indices[i]));
    }
  }
  if (!indices.empty()) dispatch::CheckPoints("BoundPoints", points);
  return Build(status, [&] {
    return TryHull<kDims>(indices.size(), [&](std::size_t i) {
      return PointAt(points, indices[i]);
    });
  });
}

}  // namespace

template <int kDims, typename Scalar>
Aabo<kDims> BoundPoints(const Points<kDims, Scalar>& points,
                        FitStatus* status) {
  return BoundHull<kDims>(points, status);
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundPoints(const PointsSoa<kDims, Scalar>& points,
                        FitStatus* status) {
  return BoundHull<kDims>(points, status);
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundPoints(const Points<kDims, Scalar>& points,
                        Span<const std::uint32_t> indices, FitStatus* status) {
  return BoundIndexed<kDims>(points, indices, status);
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundPoints(const PointsSoa<kDims, Scalar>& points,
                        Span<const std::uint32_t> indices, FitStatus* status) {
  return BoundIndexed<kDims>(points, indices, status);
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundSegment(const Segment<kDims, Scalar>& segment,
                         FitStatus* status) {
  return Build(status, [&] {
    return TryHull<kDims>(
        2, [&](std::size_t i) { return i == 0 ? segment.a : segment.b; });
  });
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundTriangle(const Triangle<kDims, Scalar>& triangle,
                          FitStatus* status) {
  return Build(status, [&] {
    return TryHull<kDims>(3, [&](std::size_t i) {
      return i == 0 ? triangle.a : i == 1 ? triangle.b : triangle.c;
    });
  });
}

#define HALFSPACE_INSTANTIATE(d, Scalar)                                   \
  template HALFSPACE_API Aabo<d> BoundPoints(const Points<d, Scalar>&,     \
                                             FitStatus*);                  \
  template HALFSPACE_API Aabo<d> BoundPoints(const PointsSoa<d, Scalar>&,  \
                                             FitStatus*);                  \
  template HALFSPACE_API Aabo<d> BoundPoints(                              \
      const Points<d, Scalar>&, Span<const std::uint32_t>, FitStatus*);    \
  template HALFSPACE_API Aabo<d> BoundPoints(                              \
      const PointsSoa<d, Scalar>&, Span<const std::uint32_t>, FitStatus*); \
  template HALFSPACE_API Aabo<d> BoundSegment(const Segment<d, Scalar>&,   \
                                              FitStatus*);                 \
  template HALFSPACE_API Aabo<d> BoundTriangle(const Triangle<d, Scalar>&, \
                                               FitStatus*)
HALFSPACE_FOR_ALL_SHAPES(HALFSPACE_INSTANTIATE);
#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace
