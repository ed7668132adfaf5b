// The kernels of shapes, of every target.
#include <cstddef>
#include <cstdint>

#include "kernels/bvh/shape.h"
#include "kernels/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/bvh/shapes.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/bvh/shapes-inl.h"
#include "kernels/bvh/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace::detail {

template <>
inline constexpr BvhShapeKernels kBvhShapeKernelsFor<HWY_TARGET> = {
    {&HWY_NAMESPACE::RunWalk<HWY_NAMESPACE::BallQuery, true>,
     &HWY_NAMESPACE::RunWalk<HWY_NAMESPACE::BallQuery, false>},
    {&HWY_NAMESPACE::RunWalk<HWY_NAMESPACE::LineQuery, true>,
     &HWY_NAMESPACE::RunWalk<HWY_NAMESPACE::LineQuery, false>},
    {&HWY_NAMESPACE::RunWalk<HWY_NAMESPACE::FrontsQuery, true>,
     &HWY_NAMESPACE::RunWalk<HWY_NAMESPACE::FrontsQuery, false>}};

}  // namespace halfspace::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::detail {
namespace {

constexpr auto kOfEachTarget = kernels::OfEachTarget<BvhShapeKernels>(
    [](auto target) { return kBvhShapeKernelsFor<target()>; });

}  // namespace

const BvhShapeKernels* const kBvhShapeKernels = kOfEachTarget.data();

}  // namespace halfspace::detail
#endif  // HWY_ONCE
