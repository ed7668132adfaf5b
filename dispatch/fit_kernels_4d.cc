// The bulk builders in 4 dimensions, once per target.
#include "dispatch/target_table.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dispatch/fit_kernels_4d.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "dispatch/fit_instantiate-inl.h"

namespace halfspace::dispatch {

template <>
const FitTable& FitTableOf<HWY_TARGET, 4>() {
  return HWY_NAMESPACE::kFitTable<4>;
}

}  // namespace halfspace::dispatch
