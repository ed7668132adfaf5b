#include "bench/baselines/gated_scan.h"

#include "bench/base/target_function.h"
#include "bench/baselines/plane_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/baselines/gated_scan.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what it is compiled for.
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// The objects of one step: a vector, the same for all widths.
constexpr size_t kStep = HWY_HAVE_SCALABLE ? 4 : hn::MaxLanes(WordTag<float>());
constexpr uint64_t kAllRejected = kLowBits<kStep>;

// One plane over the vectors of a batch; true if all its objects are rejected
// after it.
template <const auto& kOrder, size_t kPlane, class D, class V>
HWY_INLINE bool PlaneOverBatch(D d, const float* const* planes, size_t i,
                               size_t steps, uint16_t* rejected, V query) {
  constexpr bench::Plane kTest = bench::kPlaneOf<kOrder, kPlane>;
  constexpr size_t kMins = kTest.is_min ? 1 : 0;
  uint64_t all = kAllRejected;
  for (size_t s = 0; s < steps; ++s) {
    uint64_t bits = KeptBits<kMins, kStep>(d, LoadAll(), planes + kTest.object,
                                           i + s * kStep, query) ^
                    kAllRejected;
    if constexpr (kPlane != 0) bits |= rejected[s];
    rejected[s] = static_cast<uint16_t>(bits);
    all &= bits;
  }
  return all == kAllRejected;
}

template <const auto& kOrder, size_t... kPlane, class D, class... V>
HWY_INLINE void ScanBatches(std::index_sequence<kPlane...>, D d, size_t width,
                            const float* const* planes, size_t size,
                            uint64_t* mask, V... query) {
  uint16_t rejected[bench::kWidestGate / kStep];
  const size_t steps = width / kStep;
  uint64_t word = 0;
  for (size_t i = 0; i < size; i += width) {
    (void)(PlaneOverBatch<kOrder, kPlane>(d, planes, i, steps, rejected,
                                          query) ||
           ...);
    for (size_t s = 0; s < steps; ++s) {
      const size_t object = i + s * kStep;
      word |= uint64_t{rejected[s]} << object % kWordObjects;
      if ((object + kStep) % kWordObjects != 0) continue;
      mask[object / kWordObjects] = word;
      word = 0;
    }
  }
}

template <const auto& kOrder, size_t... kPlane>
void ScanShape(std::index_sequence<kPlane...> all_planes, size_t width,
               const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  const WordTag<float> d;
  ScanBatches<kOrder>(
      all_planes, d, width, planes, size, mask,
      hn::Set(d, query[bench::kPlaneOf<kOrder, kPlane>.query])...);
}

template <const auto& kOrder>
void ScanShape(size_t width, const float* const* planes, const float* query,
               size_t size, uint64_t* mask) {
  constexpr std::make_index_sequence<kOrder.size()> kPlanes{};
  ScanShape<kOrder>(kPlanes, width, planes, query, size, mask);
}

void ScanGated(bench::ShapeKind shape, size_t width, const float* const* planes,
               const float* query, size_t size, uint64_t* mask) {
  switch (shape) {
    case bench::ShapeKind::kSimplex:
      return ScanShape<bench::kSimplexOrder>(width, planes, query, size, mask);
    case bench::ShapeKind::kAabb:
      return ScanShape<bench::kAabbOrder>(width, planes, query, size, mask);
    case bench::ShapeKind::kAabo:
      return ScanShape<bench::kAaboOrder>(width, planes, query, size, mask);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
GatedScan GatedScanOf();

template <>
GatedScan GatedScanOf<HWY_TARGET>() {
  return &HWY_NAMESPACE::ScanGated;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

GatedScan GatedScanFor(Target target) {
  return FunctionOf<GatedScan>(target,
                               [](auto t) { return GatedScanOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
