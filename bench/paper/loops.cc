#include "bench/paper/loops.h"

#include <utility>

#include "bench/inner/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/paper/loops.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "bench/paper/scans-inl.h"

namespace halfspace::bench {

template <std::int64_t kTarget>
PaperLoops PaperLoopsOf();

template <>
PaperLoops PaperLoopsOf<HWY_TARGET>() {
  return {.gated = &HWY_NAMESPACE::ScanGated,
          .spheres = &HWY_NAMESPACE::ScanSpheres,
          .staged = HWY_HAVE_SCALABLE ? nullptr : &HWY_NAMESPACE::ScanStaged};
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

PaperLoops PaperLoopsFor(Target target) {
  return FunctionOf<PaperLoops>(target,
                                [](auto t) { return PaperLoopsOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
