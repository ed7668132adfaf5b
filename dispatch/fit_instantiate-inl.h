// The bulk builders in kDims dimensions, for the target being compiled.
#if defined(HALFSPACE_DISPATCH_FIT_INSTANTIATE_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_DISPATCH_FIT_INSTANTIATE_INL_H_
#undef HALFSPACE_DISPATCH_FIT_INSTANTIATE_INL_H_
#else
#define HALFSPACE_DISPATCH_FIT_INSTANTIATE_INL_H_
#endif

#include "dispatch/fit_table.h"
#include "hwy/highway.h"
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

#endif  // HALFSPACE_DISPATCH_FIT_INSTANTIATE_INL_H_
