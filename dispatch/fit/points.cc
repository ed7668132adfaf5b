// Hulls of points: sets, segments, triangles.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/fit/any_shape.h"
#include "dispatch/fit/bounding.h"
#include "dispatch/fit/point_sources.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::AxisRanges;
using dispatch::Build;
using dispatch::CanBeBounded;
using dispatch::PointAt;
using dispatch::ThrowInvalid;

// The arithmetic, for checked arguments and in the default mode: the hull of
// at(0), at(1), ..., Empty() if there are none. Nothing if a point cannot be
// bounded.
template <int kDims, typename AtIndex>
std::optional<Aabo<kDims>> TryHull(std::size_t count, const AtIndex& at) {
  AxisRanges<kDims> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    const auto point = at(i);
    if (!CanBeBounded(point)) return std::nullopt;
    ranges.AddPoint(point);
  }
  return ranges.Bound();
}

// The hull of a few points. With TryHull(), a triangle takes 1.16 of the time.
template <int kDims, typename... Corners>
std::optional<Aabo<kDims>> TryCorners(const Corners&... corners) {
  AxisRanges<kDims> ranges;
  const auto add = [&](const auto& corner) {
    if (!CanBeBounded(corner)) return false;
    ranges.AddPoint(corner);
    return true;
  };
  if (!(add(corners) && ...)) return std::nullopt;
  return ranges.Bound();
}

void CheckIndices(Span<const std::uint32_t> indices, std::size_t points) {
  if (!indices.empty()) {
    dispatch::CheckPointer(
        "BoundPoints", indices.data(), alignof(std::uint32_t),
        [] { return "indices"; },
        [&] { return std::to_string(indices.size()) + " indices"; });
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] < points) continue;
    ThrowInvalid("BoundPoints", "indices[" + std::to_string(i) + "]",
                 "less than the number of points, " + std::to_string(points),
                 std::to_string(indices[i]));
  }
}

// `any` is Points or PointsSoa.
template <template <int, typename> class Shape>
void BoundHull(const detail::AnyShape& any,
               const Span<const std::uint32_t>* indices, FitStatus* status) {
  dispatch::WithShape<Shape>(
      any, [&]<int kDims, typename Scalar>(const Shape<kDims, Scalar>& points) {
        if (indices != nullptr) CheckIndices(*indices, points.count);
        const std::size_t count =
            indices == nullptr ? points.count : indices->size();
        if (count != 0) dispatch::CheckPoints("BoundPoints", points);
        new (any.bound) Aabo<kDims>(Build(status, [&] {
          if (indices == nullptr) {
            return TryHull<kDims>(
                count, [&](std::size_t i) { return PointAt(points, i); });
          }
          return TryHull<kDims>(count, [&](std::size_t i) {
            return PointAt(points, (*indices)[i]);
          });
        }));
      });
}

}  // namespace

namespace detail {

void BoundPoints(const AnyShape& points,
                 const Span<const std::uint32_t>* indices, FitStatus* status) {
  BoundHull<Points>(points, indices, status);
}

void BoundPointsSoa(const AnyShape& points,
                    const Span<const std::uint32_t>* indices,
                    FitStatus* status) {
  BoundHull<PointsSoa>(points, indices, status);
}

void BoundSegment(const AnyShape& segment, FitStatus* status) {
  dispatch::BoundAny<Segment>(
      segment, status,
      []<int kDims, typename Scalar>(const Segment<kDims, Scalar>& its) {
        return TryCorners<kDims>(its.a, its.b);
      });
}

void BoundTriangle(const AnyShape& triangle, FitStatus* status) {
  dispatch::BoundAny<Triangle>(
      triangle, status,
      []<int kDims, typename Scalar>(const Triangle<kDims, Scalar>& its) {
        return TryCorners<kDims>(its.a, its.b, its.c);
      });
}

}  // namespace detail
}  // namespace halfspace
