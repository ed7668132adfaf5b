// The kernels in 2 dimensions, once per target.
#include "dispatch/target_table.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dispatch/kernels_2d.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "dispatch/instantiate-inl.h"

namespace halfspace::dispatch {

template <>
const KernelTable& TableOf<HWY_TARGET, 2>() {
  return HWY_NAMESPACE::kTable<2>;
}

}  // namespace halfspace::dispatch
