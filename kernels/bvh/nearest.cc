// The kernels of searches for the nearest, of every target.
#include "kernels/bvh/nearest.h"

#include <cstddef>
#include <cstdint>

#include "kernels/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/bvh/nearest.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/bvh/cast-inl.h"
#include "kernels/bvh/nearest-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace::detail {

template <>
inline constexpr BvhNearestKernels kBvhNearestKernelsFor<HWY_TARGET> = {
    &HWY_NAMESPACE::FindNearest, &HWY_NAMESPACE::CastLine};

}  // namespace halfspace::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::detail {
namespace {

constexpr auto kOfEachTarget = kernels::OfEachTarget<BvhNearestKernels>(
    [](auto target) { return kBvhNearestKernelsFor<target()>; });

}  // namespace

const BvhNearestKernels* const kBvhNearestKernels = kOfEachTarget.data();

}  // namespace halfspace::detail
#endif  // HWY_ONCE
