// The least program with a kernel in it, through the inline function, for each
// target. examples/kernels.c calls the kernel.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "one_kernel_inline.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
// After foreach_target.h.
#include <cstdint>

#include "halfspace/kernels-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace one_kernel::HWY_NAMESPACE {
std::uint64_t Test(const float* const* planes, const float* query) {
  return halfspace::HWY_NAMESPACE::SurvivorsOfFewBoxes<3>(planes, 0, 1, query);
}
}  // namespace one_kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace one_kernel {
HWY_EXPORT(Test);
}  // namespace one_kernel

int main() {
  const float zero[] = {0};
  const float one[] = {1};
  const float* planes[] = {zero, zero, zero, one, one, one};
  const float query[] = {1, 1, 1, 2, 2, 2};
  return HWY_DYNAMIC_DISPATCH(one_kernel::Test)(planes, query) == 1 ? 0 : 1;
}
#endif
