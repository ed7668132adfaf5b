// The kernels of searches for the nearest, of every target.
#include "kernels/sorted/nearest.h"

#include <cstddef>
#include <cstdint>

#include "kernels/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/sorted/nearest.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/sorted/nearest-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace::detail {

template <>
inline constexpr SortedNearestKernels kSortedNearestKernelsFor<HWY_TARGET> = {
    &HWY_NAMESPACE::FindNearest};

}  // namespace halfspace::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::detail {
namespace {

constexpr auto kOfEachTarget = kernels::OfEachTarget<SortedNearestKernels>(
    [](auto target) { return kSortedNearestKernelsFor<target()>; });

}  // namespace

const SortedNearestKernels* const kSortedNearestKernels = kOfEachTarget.data();

}  // namespace halfspace::detail
#endif  // HWY_ONCE
