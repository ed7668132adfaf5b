// Solids: boxes, spheres, capsules.
#include <array>
#include <cstddef>
#include <optional>

#include "dispatch/fit/any_shape.h"
#include "dispatch/fit/bounding.h"
#include "dispatch/outward.h"
#include "halfspace/fit.h"
#include "kernels/fit_many/root_of_dims.h"

namespace halfspace {
namespace {

using dispatch::AxisRanges;
using dispatch::CanBeBounded;
using dispatch::MagnitudeGuard;
using dispatch::OutwardSum;

template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryAabb(const Aabb<kDims, Scalar>& box) {
  if (IsEmpty(box)) return Aabo<kDims>::Empty();
  dispatch::CheckOrder("BoundAabb", box.min, box.max);
  if (!CanBeBounded(box.min) || !CanBeBounded(box.max)) return std::nullopt;
  // D falls as the coordinates rise: its extremes are at the two corners.
  AxisRanges<kDims> ranges;
  ranges.AddPoint(box.min);
  ranges.AddPoint(box.max);
  return ranges.Bound();
}

template <int kDims, typename Scalar>
void AddSphere(const Point<kDims, Scalar>& center, double radius,
               AxisRanges<kDims>& ranges) {
  const OutwardSum d = dispatch::DOf(center);
  for (const double side : {-radius, radius}) {
    for (std::size_t k = 0; k < kDims; ++k) {
      OutwardSum end(center[k]);
      end.Add(side);
      ranges.Add(k, end);
    }
    OutwardSum end = d;
    end.AddProduct(side, kernels::kRootOfDims<kDims>);
    ranges.Add(kDims, end);
  }
}

template <int kDims, typename Scalar, std::size_t kCount>
std::optional<Aabo<kDims>> TrySpheres(
    const std::array<Point<kDims, Scalar>, kCount>& centers, Scalar radius) {
  AxisRanges<kDims> ranges;
  for (const auto& center : centers) {
    MagnitudeGuard<Scalar> guard;
    guard.AddAll(center);
    guard.Add(radius);
    if (!guard.CanBeBounded()) return std::nullopt;
    AddSphere<kDims>(center, radius, ranges);
  }
  return ranges.Bound();
}

}  // namespace

void detail::BoundAabb(const AnyShape& box, FitStatus* status) {
  dispatch::BoundAny<Aabb>(box, status,
                           [](const auto& its) { return TryAabb(its); });
}

void detail::BoundSphere(const AnyShape& sphere, FitStatus* status) {
  dispatch::BoundAny<Sphere>(
      sphere, status,
      []<int kDims, typename Scalar>(const Sphere<kDims, Scalar>& its) {
        dispatch::CheckLength("BoundSphere", "sphere.radius", its.radius);
        return TrySpheres<kDims, Scalar, 1>({{its.center}}, its.radius);
      });
}

// The hull of its two end spheres.
void detail::BoundCapsule(const AnyShape& capsule, FitStatus* status) {
  dispatch::BoundAny<Capsule>(
      capsule, status,
      []<int kDims, typename Scalar>(const Capsule<kDims, Scalar>& its) {
        dispatch::CheckLength("BoundCapsule", "capsule.radius", its.radius);
        return TrySpheres<kDims, Scalar, 2>({{its.a, its.b}}, its.radius);
      });
}

}  // namespace halfspace
