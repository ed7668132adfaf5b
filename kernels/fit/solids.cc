// Solids: boxes, spheres, capsules.
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "halfspace/fit.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/exact/outward.h"
#include "kernels/exact/root_of_dims.h"

namespace halfspace {
namespace {

using kernels::CanBeBounded;
using kernels::ExactRanges;
using kernels::Finish;
using kernels::InDefaultFpMode;
using kernels::MagnitudeGuard;
using kernels::RoundDown;
using kernels::RoundUp;
using kernels::SumExactly;

template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryAabb(const Point<kDims, Scalar>& min,
                                   const Point<kDims, Scalar>& max) {
  if (!CanBeBounded(min) || !CanBeBounded(max)) return std::nullopt;
  // D falls as the coordinates rise: its extremes are at the two corners.
  ExactRanges<kDims> ranges;
  ranges.AddPoint(min);
  ranges.AddPoint(max);
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

template <int kDims>
Aabo<kDims> BoundAabb(const Aabb<kDims>& box, FitStatus* status) {
  return BoundAabb(Box<kDims>{box.min, box.max}, status);
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundAabb(const Box<kDims, Scalar>& box, FitStatus* status) {
  return InDefaultFpMode([&] {
    if (IsEmpty(Aabb<kDims, Scalar>{box.min, box.max}))
      return Finish<Aabo<kDims>>(Aabo<kDims>::Empty(), status);
    kernels::CheckOrder("BoundAabb", box.min, box.max);
    return Finish(TryAabb<kDims, Scalar>(box.min, box.max), status);
  });
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundSphere(const Sphere<kDims, Scalar>& sphere,
                        FitStatus* status) {
  return InDefaultFpMode([&] {
    kernels::CheckLength("BoundSphere", "sphere.radius", sphere.radius);
    return Finish(
        TrySpheres<kDims, Scalar, 1>({{sphere.center}}, sphere.radius), status);
  });
}

// The hull of its two end spheres.
template <int kDims, typename Scalar>
Aabo<kDims> BoundCapsule(const Capsule<kDims, Scalar>& capsule,
                         FitStatus* status) {
  return InDefaultFpMode([&] {
    kernels::CheckLength("BoundCapsule", "capsule.radius", capsule.radius);
    return Finish(
        TrySpheres<kDims, Scalar, 2>({{capsule.a, capsule.b}}, capsule.radius),
        status);
  });
}

#define HALFSPACE_INSTANTIATE_OF(d, Scalar)                                    \
  template HALFSPACE_API Aabo<d> BoundAabb(const Box<d, Scalar>&, FitStatus*); \
  template HALFSPACE_API Aabo<d> BoundSphere(const Sphere<d, Scalar>&,         \
                                             FitStatus*);                      \
  template HALFSPACE_API Aabo<d> BoundCapsule(const Capsule<d, Scalar>&,       \
                                              FitStatus*)
#define HALFSPACE_INSTANTIATE(d)                                        \
  template HALFSPACE_API Aabo<d> BoundAabb(const Aabb<d>&, FitStatus*); \
  HALFSPACE_INSTANTIATE_OF(d, float);                                   \
  HALFSPACE_INSTANTIATE_OF(d, double)
HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);
#undef HALFSPACE_INSTANTIATE
#undef HALFSPACE_INSTANTIATE_OF

}  // namespace halfspace
