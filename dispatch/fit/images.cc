// Affine images of points and of boxes; an oriented box is one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/exact_terms.h"
#include "dispatch/exact/outward.h"
#include "dispatch/fit/any_shape.h"
#include "dispatch/fit/point_sources.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::ExactRanges;
using dispatch::ExactTerms;
using dispatch::MagnitudeGuard;
using dispatch::Negated;
using dispatch::PointAt;
using dispatch::RoundDown;
using dispatch::RoundUp;

template <int kDims, typename Scalar>
bool CanBeBounded(const Point<kDims, Scalar>& point,
                  const Affine<kDims, Scalar>& map) {
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
template <int kDims, typename Scalar>
using Coordinate = ExactTerms<Scalar, std::size_t{kDims}, 1>;
template <int kDims, typename Scalar>
using CoordinateSum =
    ExactTerms<Scalar, std::size_t{kDims} * kDims, std::size_t{kDims}>;

// Adds the image of a point, unrounded. False if it cannot be bounded.
template <int kDims, typename Scalar>
bool AddImage(const Point<kDims, Scalar>& point,
              const Affine<kDims, Scalar>& map, ExactRanges<kDims>& ranges) {
  if (!CanBeBounded<kDims, Scalar>(point, map)) return false;
  CoordinateSum<kDims, Scalar> all;
  for (std::size_t k = 0; k < kDims; ++k) {
    Coordinate<kDims, Scalar> coordinate;
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

template <int kDims, typename Scalar, typename AtIndex>
std::optional<Aabo<kDims>> TryPoints(std::size_t count, const AtIndex& at,
                                     const Affine<kDims, Scalar>& map) {
  ExactRanges<kDims> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    if (!AddImage<kDims, Scalar>(at(i), map, ranges)) return std::nullopt;
  }
  return ranges.Bound();
}

// The corner of a box that is farthest from the origin.
template <int kDims, typename Scalar>
Point<kDims, Scalar> FarthestCorner(const Point<kDims, Scalar>& min,
                                    const Point<kDims, Scalar>& max) {
  Point<kDims, Scalar> corner;
  for (std::size_t k = 0; k < kDims; ++k) {
    corner[k] = -min[k] > max[k] ? min[k] : max[k];
  }
  return corner;
}

// The least and the greatest sum of factors times the coordinates of a point of
// the box: a positive factor takes the minimum for the least, a negative one
// the maximum.
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

// The sum of a few is far from overflow.
constexpr double kMostFactor = 0x1p900;

// Each axis has its extremes at two opposite corners: of all corners they are
// told by signs, so no other corner is looked at.
template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryBox(const Point<kDims, Scalar>& min,
                                  const Point<kDims, Scalar>& max,
                                  const Affine<kDims, Scalar>& map) {
  for (std::size_t k = 0; k < kDims; ++k) {
    if (!std::isfinite(min[k]) || !std::isfinite(max[k])) return std::nullopt;
    for (Scalar factor : map.linear[k]) {
      // What a map does to a coordinate of 0 does not show in the products.
      if (!(std::fabs(factor) <= kMostFactor)) return std::nullopt;
    }
  }
  if (!CanBeBounded<kDims, Scalar>(FarthestCorner<kDims, Scalar>(min, max),
                                   map)) {
    return std::nullopt;
  }
  Aabo<kDims> bound;
  Ends<CoordinateSum<kDims, Scalar>> all;
  for (std::size_t j = 0; j < kDims; ++j) {
    std::array<double, std::size_t{kDims}> column;
    for (std::size_t k = 0; k < kDims; ++k) column[k] = map.linear[k][j];
    const bool falls = dispatch::SumExactly(column).value < 0.0;
    for (std::size_t k = 0; k < kDims; ++k) {
      all.AddProduct(map.linear[k][j], falls, min[j], max[j]);
    }
  }
  for (std::size_t k = 0; k < kDims; ++k) {
    Ends<Coordinate<kDims, Scalar>> ends;
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

template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryOrientedBox(
    const OrientedBox<kDims, Scalar>& box) {
  Affine<kDims, Scalar> map;
  map.translation = box.center;
  Point<kDims, Scalar> min;
  for (std::size_t j = 0; j < kDims; ++j) {
    min[j] = -box.half_extents[j];
    for (std::size_t k = 0; k < kDims; ++k) map.linear[k][j] = box.axes[j][k];
  }
  return TryBox<kDims, Scalar>(min, box.half_extents, map);
}

// The same numbers as `To`.
template <typename To, typename From, std::size_t kCount>
std::array<To, kCount> As(const std::array<From, kCount>& from) {
  std::array<To, kCount> to;
  std::copy(from.begin(), from.end(), to.begin());
  return to;
}
template <typename To, int kDims, typename From>
Affine<kDims, To> As(const Affine<kDims, From>& from) {
  Affine<kDims, To> to;
  for (std::size_t k = 0; k < kDims; ++k) to.linear[k] = As<To>(from.linear[k]);
  to.translation = As<To>(from.translation);
  return to;
}

// As BoundAny(), of a shape's image: calls try_bound(shape, map, wide), where
// `wide` is a number of the type that holds the numbers of both.
template <template <int, typename> class Shape, typename TryBound>
void BoundImage(const detail::AnyShape& any, const void* map,
                bool is_map_double, FitStatus* status,
                const TryBound& try_bound) {
  dispatch::BoundAny<Shape>(
      any, status,
      [&]<int kDims, typename Scalar>(const Shape<kDims, Scalar>& shape) {
        if (is_map_double) {
          return try_bound(
              shape, *static_cast<const Affine<kDims, double>*>(map), double{});
        }
        return try_bound(shape, *static_cast<const Affine<kDims>*>(map),
                         Scalar{});
      });
}

}  // namespace

void detail::BoundOrientedBox(const AnyShape& box, FitStatus* status) {
  constexpr std::array kNames = {"box.half_extents[0]", "box.half_extents[1]",
                                 "box.half_extents[2]", "box.half_extents[3]"};
  dispatch::BoundAny<OrientedBox>(box, status, [&](const auto& its) {
    for (std::size_t i = 0; i < its.half_extents.size(); ++i) {
      dispatch::CheckLength("BoundOrientedBox", kNames[i], its.half_extents[i]);
    }
    return TryOrientedBox(its);
  });
}

void detail::BoundImageOfPoints(const AnyShape& points, const void* map,
                                bool is_map_double, FitStatus* status) {
  BoundImage<Points>(
      points, map, is_map_double, status,
      []<int kDims, typename Scalar, typename Wide>(
          const Points<kDims, Scalar>& its, const auto& its_map, Wide) {
        if (its.count != 0) dispatch::CheckPoints("BoundTransformed", its);
        const auto at = [&](std::size_t i) {
          return As<Wide>(PointAt(its, i));
        };
        return TryPoints<kDims, Wide>(its.count, at, As<Wide>(its_map));
      });
}

void detail::BoundImageOfBox(const AnyShape& box, const void* map,
                             bool is_map_double, FitStatus* status) {
  BoundImage<Aabb>(box, map, is_map_double, status,
                   []<int kDims, typename Scalar, typename Wide>(
                       const Aabb<kDims, Scalar>& its, const auto& its_map,
                       Wide) -> std::optional<Aabo<kDims>> {
                     if (IsEmpty(its)) return Aabo<kDims>::Empty();
                     dispatch::CheckOrder("BoundTransformed", its.min, its.max);
                     return TryBox<kDims, Wide>(As<Wide>(its.min),
                                                As<Wide>(its.max),
                                                As<Wide>(its_map));
                   });
}

}  // namespace halfspace
