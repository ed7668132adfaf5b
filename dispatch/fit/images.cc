// Affine images of points and of boxes; an oriented box is one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "dispatch/fit/any_shape.h"
#include "dispatch/fit/bounding.h"
#include "dispatch/fit/point_sources.h"
#include "dispatch/outward.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::AxisRanges;
using dispatch::MagnitudeGuard;
using dispatch::OutwardSum;
using dispatch::PointAt;

// Adds the image of a point, unrounded. False if it cannot be bounded.
template <int kDims, typename Scalar>
bool AddImage(const Point<kDims, Scalar>& point,
              const Affine<kDims, Scalar>& map, AxisRanges<kDims>& ranges) {
  MagnitudeGuard<double> guard;
  OutwardSum d;
  for (std::size_t k = 0; k < kDims; ++k) {
    OutwardSum coordinate(map.translation[k]);
    guard.Add(map.translation[k]);
    for (std::size_t j = 0; j < kDims; ++j) {
      guard.Add(double{map.linear[k][j]} * double{point[j]});
      coordinate.AddProduct(map.linear[k][j], point[j]);
    }
    ranges.Add(k, coordinate);
    d.Add(-coordinate);
  }
  ranges.Add(kDims, d);
  return guard.CanBeBounded();
}

template <int kDims, typename Scalar, typename AtIndex>
std::optional<Aabo<kDims>> TryPoints(std::size_t count, const AtIndex& at,
                                     const Affine<kDims, Scalar>& map) {
  AxisRanges<kDims> ranges;
  for (std::size_t i = 0; i < count; ++i) {
    if (!AddImage<kDims, Scalar>(at(i), map, ranges)) return std::nullopt;
  }
  return ranges.Bound();
}

// A sum of intervals.
struct Ends {
  OutwardSum low;
  OutwardSum high;

  void Add(double number) {
    low.Add(number);
    high.Add(number);
  }
  // The interval between two sums, in any order. If their errors hide which of
  // them is less, then by no more than the larger error.
  void Add(const OutwardSum& a, const OutwardSum& b) {
    const double error = std::max(a.error(), b.error());
    low.Add(OutwardSum(std::min(a.value(), b.value()), error));
    high.Add(OutwardSum(std::max(a.value(), b.value()), error));
  }
};

// Each coordinate of the box adds to an axis its product with one of its ends.
template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryBox(const Point<kDims, Scalar>& min,
                                  const Point<kDims, Scalar>& max,
                                  const Affine<kDims, Scalar>& map) {
  MagnitudeGuard<double> guard;
  std::array<Ends, std::size_t{kDims}> axes;
  Ends all;  // the sum of all axes
  for (std::size_t k = 0; k < kDims; ++k) {
    if (!std::isfinite(min[k]) || !std::isfinite(max[k])) return std::nullopt;
    guard.Add(map.translation[k]);
    axes[k].Add(map.translation[k]);
    all.Add(map.translation[k]);
  }
  for (std::size_t j = 0; j < kDims; ++j) {
    const auto farthest = std::max(-min[j], max[j]);
    OutwardSum at_min;
    OutwardSum at_max;
    for (std::size_t k = 0; k < kDims; ++k) {
      const auto low = OutwardSum::ProductOf(map.linear[k][j], min[j]);
      const auto high = OutwardSum::ProductOf(map.linear[k][j], max[j]);
      guard.Add(double{map.linear[k][j]} * double{farthest});
      axes[k].Add(low, high);
      at_min.Add(low);
      at_max.Add(high);
    }
    all.Add(at_min, at_max);
  }
  if (!guard.CanBeBounded()) return std::nullopt;
  Aabo<kDims> bound;
  for (std::size_t k = 0; k < kDims; ++k) {
    bound.min[k] = axes[k].low.Down();
    bound.max[k] = axes[k].high.Up();
  }
  bound.min[kDims] = -all.high.Up();
  bound.max[kDims] = -all.low.Down();
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

// Converts each number to the type `To`.
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
