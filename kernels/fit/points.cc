// Hulls of points: sets, segments, triangles.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "halfspace/fit.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/fit/point_sources.h"
#include "kernels/memory_checks.h"

namespace halfspace {
namespace {

using kernels::CanBeBounded;
using kernels::ExactRanges;
using kernels::Finish;
using kernels::InDefaultFpMode;
using kernels::PointAt;
using kernels::ThrowInvalid;

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
  if (points.count != 0) kernels::CheckPoints("BoundPoints", points);
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) { return PointAt(points, i); };
    return Finish(TryHull<kDims>(points.count, at), status);
  });
}

template <int kDims, typename Source>
Aabo<kDims> BoundIndexed(const Source& points,
                         Span<const std::uint32_t> indices, FitStatus* status) {
  if (!indices.empty()) {
    kernels::CheckPointer(
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
  if (!indices.empty()) kernels::CheckPoints("BoundPoints", points);
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) { return PointAt(points, indices[i]); };
    return Finish(TryHull<kDims>(indices.size(), at), status);
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
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) {
      return i == 0 ? segment.a : segment.b;
    };
    return Finish(TryHull<kDims>(2, at), status);
  });
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundTriangle(const Triangle<kDims, Scalar>& triangle,
                          FitStatus* status) {
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) {
      return i == 0 ? triangle.a : i == 1 ? triangle.b : triangle.c;
    };
    return Finish(TryHull<kDims>(3, at), status);
  });
}

#define HALFSPACE_INSTANTIATE_OF(d, Scalar)                                \
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
#define HALFSPACE_INSTANTIATE(d)      \
  HALFSPACE_INSTANTIATE_OF(d, float); \
  HALFSPACE_INSTANTIATE_OF(d, double)
HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);
#undef HALFSPACE_INSTANTIATE
#undef HALFSPACE_INSTANTIATE_OF

}  // namespace halfspace
