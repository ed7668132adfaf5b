// The kernels of shapes, of every target.
#include <cstddef>
#include <cstdint>

#include "kernels/compiled_targets.h"
#include "kernels/sorted/shape.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/sorted/shapes.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/sorted/shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace::detail {

template <>
inline constexpr SortedShapeKernels kSortedShapeKernelsFor<HWY_TARGET> = {
    &HWY_NAMESPACE::LineCodeBits,     &HWY_NAMESPACE::BallBits,
    &HWY_NAMESPACE::InBallBits,       &HWY_NAMESPACE::LineBits,
    &HWY_NAMESPACE::FrontBits<false>, &HWY_NAMESPACE::FrontBits<true>};

}  // namespace halfspace::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::detail {
namespace {

constexpr auto kOfEachTarget = kernels::OfEachTarget<SortedShapeKernels>(
    [](auto target) { return kSortedShapeKernelsFor<target()>; });

}  // namespace

const SortedShapeKernels* const kSortedShapeKernels = kOfEachTarget.data();

}  // namespace halfspace::detail
#endif  // HWY_ONCE
