// Affine images of points and of boxes; an oriented box is one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "halfspace/fit.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/exact/exact_terms.h"
#include "kernels/exact/outward.h"
#include "kernels/fit/point_sources.h"

namespace halfspace {
namespace {

using kernels::ExactRanges;
using kernels::ExactTerms;
using kernels::Finish;
using kernels::InDefaultFpMode;
using kernels::MagnitudeGuard;
using kernels::Negated;
using kernels::PointAt;
using kernels::RoundDown;
using kernels::RoundUp;

template <int kDims>
bool CanBeBounded(const Point<kDims>& point, const Affine<kDims>& map) {
  MagnitudeGuard<double> guard;
  for (std::size_t k = 0; k < kDims; ++k) {
    for (std::size_t j = 0; j < kDims; ++j) {
      guard.Add(double{map.linear[k][j]} * double{point[j]});
    }
    guard.Add(map.translation[k]);
  }
  return guard.CanBeBounded();
}

// A coordinate of an image, and the sum of all of them.
template <int kDims>
using Coordinate = ExactTerms<float, std::size_t{kDims}, 1>;
template <int kDims>
using CoordinateSum =
    ExactTerms<float, std::size_t{kDims} * kDims, std::size_t{kDims}>;

// Adds the image of a point, unrounded. False if it cannot be bounded.
template <int kDims>
bool AddImage(const Point<kDims>& point, const Affine<kDims>& map,
              ExactRanges<kDims>& ranges) {
  if (!CanBeBounded(point, map)) return false;
  CoordinateSum<kDims> all;
  for (std::size_t k = 0; k < kDims; ++k) {
    Coordinate<kDims> coordinate;
    for (std::size_t j = 0; j < kDims; ++j) {
      coordinate.AddProduct(map.linear[k][j], point[j]);
      all.AddProduct(map.linear[k][j], point[j]);
    }
    coordinate.Add(map.translation[k]);
    all.Add(map.translation[k]);
    ranges.Add(k, coordinate.SumToRound());
  }
  ranges.Add(kDims, Negated(all.SumToRound()));
  return true;
}

template <int kDims, typename AtIndex>
std::optional<Aabo<kDims>> TryPoints(std::size_t count, const AtIndex& at,
                                     const Affine<kDims>& map) {
  ExactRanges<kDims> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    if (!AddImage(at(i), map, ranges)) return std::nullopt;
  }
  return ranges.Bound();
}

// The corner of a box that is farthest from the origin.
template <int kDims>
Point<kDims> FarthestCorner(const Point<kDims>& min, const Point<kDims>& max) {
  Point<kDims> corner;
  for (std::size_t k = 0; k < kDims; ++k) {
    corner[k] = -min[k] > max[k] ? min[k] : max[k];
  }
  return corner;
}

// The two ends of a sum of numbers times the box's coordinates, each of which
// is at the end that the sign of its factor asks for.
template <typename Terms>
struct Ends {
  Terms low;
  Terms high;

  // Without a branch on `falls`, which nobody can predict.
  template <typename Scalar>
  void AddProduct(Scalar factor, bool falls, Scalar min, Scalar max) {
    const std::array<Scalar, 2> ends = {min, max};
    low.AddProduct(factor, ends[falls ? 1 : 0]);
    high.AddProduct(factor, ends[falls ? 0 : 1]);
  }
  template <typename Scalar>
  void Add(Scalar number) {
    low.Add(number);
    high.Add(number);
  }
};

// Each axis has its extremes at two opposite corners: of all corners they are
// told by signs, so no other corner is looked at.
template <int kDims>
std::optional<Aabo<kDims>> TryBox(const Point<kDims>& min,
                                  const Point<kDims>& max,
                                  const Affine<kDims>& map) {
  for (std::size_t k = 0; k < kDims; ++k) {
    if (!std::isfinite(min[k]) || !std::isfinite(max[k])) return std::nullopt;
  }
  if (!CanBeBounded<kDims>(FarthestCorner<kDims>(min, max), map)) {
    return std::nullopt;
  }
  Aabo<kDims> bound;
  Ends<CoordinateSum<kDims>> all;
  for (std::size_t j = 0; j < kDims; ++j) {
    std::array<double, std::size_t{kDims}> column;
    for (std::size_t k = 0; k < kDims; ++k) column[k] = map.linear[k][j];
    const bool falls = kernels::SumExactly(column).value < 0.0;
    for (std::size_t k = 0; k < kDims; ++k) {
      all.AddProduct(map.linear[k][j], falls, min[j], max[j]);
    }
  }
  for (std::size_t k = 0; k < kDims; ++k) {
    Ends<Coordinate<kDims>> ends;
    for (std::size_t j = 0; j < kDims; ++j) {
      const auto factor = map.linear[k][j];
      ends.AddProduct(factor, factor < 0, min[j], max[j]);
    }
    ends.Add(map.translation[k]);
    all.Add(map.translation[k]);
    bound.min[k] = RoundDown(ends.low.SumToRound());
    bound.max[k] = RoundUp(ends.high.SumToRound());
  }
  bound.min[kDims] = RoundDown(Negated(all.high.SumToRound()));
  bound.max[kDims] = RoundUp(Negated(all.low.SumToRound()));
  return bound;
}

template <int kDims>
std::optional<Aabo<kDims>> TryOrientedBox(const OrientedBox<kDims>& box) {
  Affine<kDims> map;
  map.translation = box.center;
  Point<kDims> min;
  for (std::size_t j = 0; j < kDims; ++j) {
    min[j] = -box.half_extents[j];
    for (std::size_t k = 0; k < kDims; ++k) map.linear[k][j] = box.axes[j][k];
  }
  return TryBox<kDims>(min, box.half_extents, map);
}

}  // namespace

template <int kDims>
Aabo<kDims> BoundOrientedBox(const OrientedBox<kDims>& box, FitStatus* status) {
  constexpr std::array kNames = {"box.half_extents[0]", "box.half_extents[1]",
                                 "box.half_extents[2]", "box.half_extents[3]"};
  return InDefaultFpMode([&] {
    for (std::size_t i = 0; i < kDims; ++i) {
      kernels::CheckLength("BoundOrientedBox", kNames[i], box.half_extents[i]);
    }
    return Finish(TryOrientedBox(box), status);
  });
}

template <int kDims>
Aabo<kDims> BoundTransformed(const Points<kDims>& points,
                             const Affine<kDims>& map, FitStatus* status) {
  if (points.count != 0) kernels::CheckPoints("BoundTransformed", points);
  return InDefaultFpMode([&] {
    const auto at = [&](std::size_t i) { return PointAt(points, i); };
    return Finish(TryPoints(points.count, at, map), status);
  });
}

template <int kDims>
Aabo<kDims> BoundTransformed(const Aabb<kDims>& box, const Affine<kDims>& map,
                             FitStatus* status) {
  return InDefaultFpMode([&] {
    if (IsEmpty(box)) {
      return Finish<Aabo<kDims>>(Aabo<kDims>::Empty(), status);
    }
    kernels::CheckOrder("BoundTransformed", box.min, box.max);
    return Finish(TryBox<kDims>(box.min, box.max, map), status);
  });
}

#define HALFSPACE_INSTANTIATE(d)                                         \
  template HALFSPACE_API Aabo<d> BoundOrientedBox(const OrientedBox<d>&, \
                                                  FitStatus*);           \
  template HALFSPACE_API Aabo<d> BoundTransformed(                       \
      const Points<d>&, const Affine<d>&, FitStatus*);                   \
  template HALFSPACE_API Aabo<d> BoundTransformed(                       \
      const Aabb<d>&, const Affine<d>&, FitStatus*)
HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);
#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace
