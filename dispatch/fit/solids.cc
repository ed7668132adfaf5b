// Solids: boxes, spheres, capsules.
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/outward.h"
#include "dispatch/fit/any_shape.h"
#include "halfspace/fit.h"
#include "kernels/fit_many/root_of_dims.h"

namespace halfspace {
namespace {

using dispatch::CanBeBounded;
using dispatch::ExactRanges;
using dispatch::MagnitudeGuard;
using dispatch::RoundDown;
using dispatch::RoundUp;
using dispatch::SumExactly;

template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryAabb(const Aabb<kDims, Scalar>& box) {
  if (IsEmpty(box)) return Aabo<kDims>::Empty();
  dispatch::CheckOrder("BoundAabb", box.min, box.max);
  if (!CanBeBounded(box.min) || !CanBeBounded(box.max)) return std::nullopt;
  // D falls as the coordinates rise: its extremes are at the two corners.
  ExactRanges<kDims> ranges;
  ranges.AddPoint(box.min);
  ranges.AddPoint(box.max);
  return ranges.Bound();
}

template <int kDims, typename Scalar>
void AddSphere(const Point<kDims, Scalar>& center, Scalar radius,
               Aabo<kDims>& bound) {
  constexpr std::size_t kParts = kernels::kRootParts;
  const auto reach = kernels::TimesRootOfDims<kDims>(radius);
  std::array<double, kDims + kParts> up;
  std::array<double, kDims + kParts> down;
  for (std::size_t k = 0; k < kDims; ++k) {
    const std::array<double, 2> high = {center[k], radius};
    const std::array<double, 2> low = {center[k], -double{radius}};
    bound.min[k] = std::min(bound.min[k], RoundDown(SumExactly(low)));
    bound.max[k] = std::max(bound.max[k], RoundUp(SumExactly(high)));
    up[k] = down[k] = -double{center[k]};
  }
  for (std::size_t i = 0; i < kParts; ++i) {
    up[kDims + i] = reach[i];
    down[kDims + i] = -reach[i];
  }
  bound.min[kDims] = std::min(bound.min[kDims], RoundDown(SumExactly(down)));
  bound.max[kDims] = std::max(bound.max[kDims], RoundUp(SumExactly(up)));
}

template <int kDims, typename Scalar, std::size_t kCount>
std::optional<Aabo<kDims>> TrySpheres(
    const std::array<Point<kDims, Scalar>, kCount>& centers, Scalar radius) {
  Aabo<kDims> bound = Aabo<kDims>::Empty();
  for (const auto& center : centers) {
    MagnitudeGuard<Scalar> guard;
    guard.AddAll(center);
    guard.Add(radius);
    if (!guard.CanBeBounded()) return std::nullopt;
    AddSphere<kDims>(center, radius, bound);
  }
  return bound;
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
