// The bulk builders, once per target.
#include "dispatch/target_table.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dispatch/fit_kernels.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/fit_boxes-inl.h"
#include "kernels/fit_point_sets-inl.h"
#include "kernels/fit_spheres-inl.h"
#include "kernels/fit_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// In the order of dispatch::FitSource.
template <int kDims>
inline constexpr dispatch::FitTable kFitTable = {{
    {&FitBoxes<kDims, Rounding::kWithinUlp>,
     &FitBoxes<kDims, Rounding::kTightest>},
    {&FitSpheres<kDims, Rounding::kWithinUlp>,
     &FitSpheres<kDims, Rounding::kTightest>},
    {&FitTriangles<kDims, Rounding::kWithinUlp>,
     &FitTriangles<kDims, Rounding::kTightest>},
    {&FitPointSets<kDims, Rounding::kWithinUlp>,
     &FitPointSets<kDims, Rounding::kTightest>},
}};

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::dispatch {

template <>
const FitTable& FitTableOf<HWY_TARGET, 2>() {
  return HWY_NAMESPACE::kFitTable<2>;
}
template <>
const FitTable& FitTableOf<HWY_TARGET, 3>() {
  return HWY_NAMESPACE::kFitTable<3>;
}
template <>
const FitTable& FitTableOf<HWY_TARGET, 4>() {
  return HWY_NAMESPACE::kFitTable<4>;
}

}  // namespace halfspace::dispatch
