// Hulls of points: sets, segments, triangles, and their affine images.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "halfspace/fit.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/exact/outward.h"
#include "kernels/memory_checks.h"

namespace halfspace {
namespace {

using kernels::CanBeBounded;
using kernels::ExactRanges;
using kernels::Finish;
using kernels::InDefaultFpMode;
using kernels::MagnitudeGuard;
using kernels::SumExactly;
using kernels::ThrowInvalid;

// name() is made only for a message.
template <typename Scalar, typename Name>
void CheckPlace(std::string_view call, const Scalar* coords, std::size_t count,
                const Name& name) {
  kernels::CheckPointer(call, coords, alignof(Scalar), name,
                        [&] { return std::to_string(count) + " points"; });
}

template <int kDims, typename Scalar>
void Check(std::string_view call, const Points<kDims, Scalar>& points) {
  CheckPlace(call, points.coords, points.count, [] { return "points.coords"; });
  kernels::CheckExtent(call, "points", sizeof(Scalar), points.count,
                       points.stride, kDims);
}

template <int kDims, typename Scalar>
void Check(std::string_view call, const PointsSoa<kDims, Scalar>& points) {
  for (std::size_t k = 0; k < kDims; ++k) {
    CheckPlace(call, points.coords[k], points.count,
               [&] { return "points.coords[" + std::to_string(k) + "]"; });
  }
  kernels::CheckExtent(call, "points", sizeof(Scalar), points.count, 1, 1);
}

template <int kDims, typename Scalar>
Point<kDims, Scalar> At(const Points<kDims, Scalar>& points, std::size_t i) {
  Point<kDims, Scalar> point;
  for (std::size_t k = 0; k < kDims; ++k) {
    point[k] = points.coords[i * points.stride + k];
  }
  return point;
}

template <int kDims, typename Scalar>
Point<kDims, Scalar> At(const PointsSoa<kDims, Scalar>& points, std::size_t i) {
  Point<kDims, Scalar> point;
  for (std::size_t k = 0; k < kDims; ++k) point[k] = points.coords[k][i];
  return point;
}

// The arithmetic, for checked arguments and in the default mode: the hull of
// at(0), at(1), ..., Empty() if there are none. Nothing if a point cannot be
// bounded.
template <int kDims, typename PointAt>
std::optional<Aabo<kDims>> TryHull(std::size_t count, const PointAt& at) {
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
  if (points.count != 0) Check("BoundPoints", points);
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) { return At(points, i); };
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
  if (!indices.empty()) Check("BoundPoints", points);
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) { return At(points, indices[i]); };
    return Finish(TryHull<kDims>(indices.size(), at), status);
  });
}

// Adds the image of a point, unrounded: products of two floats are exact in
// double. False if it cannot be bounded.
template <int kDims>
bool AddImage(const Point<kDims>& point, const Affine<kDims>& map,
              ExactRanges<kDims>& ranges) {
  std::array<std::array<double, kDims + 1>, kDims> rows;
  std::array<double, kDims*(kDims + 1)> all;
  MagnitudeGuard<double> guard;
  auto next = all.begin();
  for (std::size_t k = 0; k < kDims; ++k) {
    for (std::size_t j = 0; j < kDims; ++j) {
      rows[k][j] = double{map.linear[k][j]} * double{point[j]};
    }
    rows[k][kDims] = map.translation[k];
    guard.AddAll(rows[k]);
    next = std::copy(rows[k].begin(), rows[k].end(), next);
  }
  if (!guard.CanBeBounded()) return false;
  for (std::size_t k = 0; k < kDims; ++k) ranges.Add(k, SumExactly(rows[k]));
  ranges.Add(kDims, kernels::Negated(SumExactly(all)));
  return true;
}

template <int kDims, typename PointAt>
std::optional<Aabo<kDims>> TryImage(std::size_t count, const PointAt& at,
                                    const Affine<kDims>& map) {
  ExactRanges<kDims> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    if (!AddImage(at(i), map, ranges)) return std::nullopt;
  }
  return ranges.Bound();
}

}  // namespace

template <int kDims>
Aabo<kDims> BoundPoints(const Points<kDims>& points, FitStatus* status) {
  return BoundHull<kDims>(points, status);
}

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

template <int kDims>
Aabo<kDims> BoundPoints(const Points<kDims>& points,
                        Span<const std::uint32_t> indices, FitStatus* status) {
  return BoundIndexed<kDims>(points, indices, status);
}

template <int kDims>
Aabo<kDims> BoundPoints(const PointsSoa<kDims>& points,
                        Span<const std::uint32_t> indices, FitStatus* status) {
  return BoundIndexed<kDims>(points, indices, status);
}

template <int kDims>
Aabo<kDims> BoundSegment(const Segment<kDims>& segment, FitStatus* status) {
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) {
      return i == 0 ? segment.a : segment.b;
    };
    return Finish(TryHull<kDims>(2, at), status);
  });
}

template <int kDims>
Aabo<kDims> BoundTriangle(const Triangle<kDims>& triangle, FitStatus* status) {
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) {
      return i == 0 ? triangle.a : i == 1 ? triangle.b : triangle.c;
    };
    return Finish(TryHull<kDims>(3, at), status);
  });
}

template <int kDims>
Aabo<kDims> BoundTransformed(const Points<kDims>& points,
                             const Affine<kDims>& map, FitStatus* status) {
  if (points.count != 0) Check("BoundTransformed", points);
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) { return At(points, i); };
    return Finish(TryImage(points.count, at, map), status);
  });
}

template <int kDims>
Aabo<kDims> BoundTransformed(const Aabb<kDims>& box, const Affine<kDims>& map,
                             FitStatus* status) {
  return InDefaultFpMode([&] {
    if (box == Aabb<kDims>::Empty()) {
      return Finish<Aabo<kDims>>(Aabo<kDims>::Empty(), status);
    }
    kernels::CheckOrder("BoundTransformed", box.min, box.max);
    // Bit k of a corner's number says which end of axis k it has.
    const auto corner = [&](std::size_t i) {
      Point<kDims> point;
      for (std::size_t k = 0; k < kDims; ++k) {
        point[k] = ((i >> k) & 1) == 0 ? box.min[k] : box.max[k];
      }
      return point;
    };
    return Finish(TryImage(std::size_t{1} << kDims, corner, map), status);
  });
}

#define HALFSPACE_INSTANTIATE(d)                                               \
  template HALFSPACE_API Aabo<d> BoundPoints(const Points<d>&, FitStatus*);    \
  template HALFSPACE_API Aabo<d> BoundPoints(const Points<d, double>&,         \
                                             FitStatus*);                      \
  template HALFSPACE_API Aabo<d> BoundPoints(const PointsSoa<d>&, FitStatus*); \
  template HALFSPACE_API Aabo<d> BoundPoints(const PointsSoa<d, double>&,      \
                                             FitStatus*);                      \
  template HALFSPACE_API Aabo<d> BoundPoints(                                  \
      const Points<d>&, Span<const std::uint32_t>, FitStatus*);                \
  template HALFSPACE_API Aabo<d> BoundPoints(                                  \
      const PointsSoa<d>&, Span<const std::uint32_t>, FitStatus*);             \
  template HALFSPACE_API Aabo<d> BoundSegment(const Segment<d>&, FitStatus*);  \
  template HALFSPACE_API Aabo<d> BoundTriangle(const Triangle<d>&,             \
                                               FitStatus*);                    \
  template HALFSPACE_API Aabo<d> BoundTransformed(                             \
      const Points<d>&, const Affine<d>&, FitStatus*);                         \
  template HALFSPACE_API Aabo<d> BoundTransformed(                             \
      const Aabb<d>&, const Affine<d>&, FitStatus*)
HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);
#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace
