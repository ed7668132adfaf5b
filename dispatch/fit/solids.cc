// Solids: boxes, spheres, capsules.
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/outward.h"
#include "dispatch/fit/instantiate.h"
#include "halfspace/fit.h"
#include "kernels/fit_many/root_of_dims.h"

namespace halfspace {
namespace {

using dispatch::Build;
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

template <int kDims, typename Scalar>
Aabo<kDims> BoundAabb(const Aabb<kDims, Scalar>& box, FitStatus* status) {
  return Build(status, [&] { return TryAabb(box); });
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundSphere(const Sphere<kDims, Scalar>& sphere,
                        FitStatus* status) {
  return Build(status, [&] {
    dispatch::CheckLength("BoundSphere", "sphere.radius", sphere.radius);
    return TrySpheres<kDims, Scalar, 1>({{sphere.center}}, sphere.radius);
  });
}

// The hull of its two end spheres.
template <int kDims, typename Scalar>
Aabo<kDims> BoundCapsule(const Capsule<kDims, Scalar>& capsule,
                         FitStatus* status) {
  return Build(status, [&] {
    dispatch::CheckLength("BoundCapsule", "capsule.radius", capsule.radius);
    return TrySpheres<kDims, Scalar, 2>({{capsule.a, capsule.b}},
                                        capsule.radius);
  });
}

#define HALFSPACE_INSTANTIATE(d, Scalar)                                 \
  template HALFSPACE_API Aabo<d> BoundAabb(const Aabb<d, Scalar>&,       \
                                           FitStatus*);                  \
  template HALFSPACE_API Aabo<d> BoundSphere(const Sphere<d, Scalar>&,   \
                                             FitStatus*);                \
  template HALFSPACE_API Aabo<d> BoundCapsule(const Capsule<d, Scalar>&, \
                                              FitStatus*)
HALFSPACE_FOR_ALL_SHAPES(HALFSPACE_INSTANTIATE);
#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace
