#include "bench/inner/target_loops.h"

#include <utility>

#include "bench/base/target_function.h"
#include "bench/inner/plane_order.h"
#include "dispatch/scan/prepare.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/inner/target_loops.cc"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/scan/stages-inl.h"

// After the kernels, whose parts they use.
#include "bench/inner/gated_scan-inl.h"
#include "bench/inner/memory_loops-inl.h"
#include "bench/inner/vectorised-inl.h"
#include "bench/inner/volume_scans-inl.h"
#include "bench/inner/width_scans-inl.h"

namespace halfspace::bench {

template <std::int64_t kTarget>
TargetLoops LoopsOf();

template <>
TargetLoops LoopsOf<HWY_TARGET>() {
  return {.one_query_lanes = &HWY_NAMESPACE::OneQueryLanes,
          .read = &HWY_NAMESPACE::ReadPlanes,
          .copy = &HWY_NAMESPACE::CopyStreams,
          .scan_gated = &HWY_NAMESPACE::ScanGated,
          .scan_staged = &HWY_NAMESPACE::ScanStaged,
          .fill_plane_words = &HWY_NAMESPACE::FillPlaneWords,
          .scan_seven_sided = &HWY_NAMESPACE::ScanSevenSided,
          .scan_spheres = &HWY_NAMESPACE::ScanSpheres,
          .scan_spheres_by_axis = &HWY_NAMESPACE::ScanSpheresByAxis,
          .count_by_or = &HWY_NAMESPACE::CountSimplices<true>,
          .count_by_and = &HWY_NAMESPACE::CountSimplices<false>,
          .widths = {HWY_NAMESPACE::LoopsOfWidth<1>(),
                     HWY_NAMESPACE::LoopsOfWidth<4>(),
                     HWY_NAMESPACE::LoopsOfWidth<8>(),
                     HWY_NAMESPACE::LoopsOfWidth<16>()}};
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

TargetLoops LoopsFor(Target target) {
  return FunctionOf<TargetLoops>(target, [](auto t) { return LoopsOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
