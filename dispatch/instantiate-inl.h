// Fills one KernelTable: every shape, schedule and sink in kDims dimensions,
// for the target being compiled.
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
#include "kernels/reject-inl.h"
#include "kernels/sinks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <class Shape>
int64_t MaskKernel(const float* const* planes, const float* query, size_t size,
                   uint64_t* mask, uint64_t flip) {
  MaskSink sink{mask, flip};
  ScanWorld<Shape>(planes, query, size, sink);
  return HWY_TARGET;
}

template <class Shape>
dispatch::Counted IndexKernel(const float* const* planes, const float* query,
                              size_t size, uint32_t* indices, size_t capacity) {
  IndexSink sink{indices, capacity};
  ScanWorld<Shape>(planes, query, size, sink);
  return {sink.count, HWY_TARGET};
}

template <class Shape>
dispatch::Counted CountKernel(const float* const* planes, const float* query,
                              size_t size) {
  CountSink sink;
  ScanWorld<Shape>(planes, query, size, sink);
  return {sink.count, HWY_TARGET};
}

template <class Shape>
dispatch::Counted AnyKernel(const float* const* planes, const float* query,
                            size_t size) {
  AnySink sink;
  ScanWorld<Shape>(planes, query, size, sink);
  return {sink.any ? size_t{1} : size_t{0}, HWY_TARGET};
}

template <class Shape>
constexpr dispatch::Kernels KernelsOf() {
  return {&MaskKernel<Shape>, &IndexKernel<Shape>, &CountKernel<Shape>,
          &AnyKernel<Shape>};
}

// In the order of dispatch::Variant.
template <int kDims>
inline constexpr dispatch::KernelTable kTable = {
    KernelsOf<kernels::SimplexFlat<kDims>>(),
    KernelsOf<kernels::SimplexByAxis<kDims>>(),
    KernelsOf<kernels::AabbFlat<kDims>>(),
    KernelsOf<kernels::AabbByAxis<kDims>>(),
    KernelsOf<kernels::AaboFlat<kDims>>(),
    KernelsOf<kernels::AaboByAxis<kDims>>(),
    KernelsOf<kernels::AaboBySimplex<kDims>>(),
};

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_DISPATCH_INSTANTIATE_INL_H_
