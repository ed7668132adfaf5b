// Fills one KernelTable: every element type, shape and schedule in kDims
// dimensions, for the target being compiled.
#if defined(HALFSPACE_DISPATCH_INSTANTIATE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_DISPATCH_INSTANTIATE_INL_H_
#undef HALFSPACE_DISPATCH_INSTANTIATE_INL_H_
#else
#define HALFSPACE_DISPATCH_INSTANTIATE_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "dispatch/kernel_table.h"
#include "hwy/highway.h"
#include "kernels/live_words-inl.h"
#include "kernels/reject-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <class Shape, typename T>
int64_t MaskKernel(const kernels::MaskJob& job) {
  return Scan<Shape, T>(job);
}

inline uint64_t LiveSurvivorWords(const uint64_t* words, size_t count) {
  return LiveWords(words, count, 0);
}

template <int kDims, typename T>
constexpr dispatch::MaskKernel AaboUpKernel() {
  if constexpr (sizeof(T) < sizeof(float)) {
    return &MaskKernel<kernels::AaboUp<kDims>, T>;
  } else {
    return nullptr;
  }
}

// In the order of dispatch::Variant.
template <int kDims, typename T>
constexpr std::array<dispatch::MaskKernel, dispatch::kVariants> MaskKernels() {
  return {&MaskKernel<kernels::SimplexFlat<kDims>, T>,
          &MaskKernel<kernels::SimplexByAxis<kDims>, T>,
          &MaskKernel<kernels::AabbFlat<kDims>, T>,
          &MaskKernel<kernels::AabbByAxis<kDims>, T>,
          &MaskKernel<kernels::AaboFlat<kDims>, T>,
          &MaskKernel<kernels::AaboByAxis<kDims>, T>,
          &MaskKernel<kernels::AaboBySimplex<kDims>, T>,
          AaboUpKernel<kDims, T>()};
}

// In the order of detail::Element.
template <int kDims>
inline constexpr dispatch::KernelTable kTable = {
    {MaskKernels<kDims, float>(), MaskKernels<kDims, double>(),
     MaskKernels<kDims, int8_t>(), MaskKernels<kDims, int16_t>()},
    &LiveSurvivorWords,
    &CountSurvivors};

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_DISPATCH_INSTANTIATE_INL_H_
