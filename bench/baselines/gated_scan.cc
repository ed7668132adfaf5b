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

// Objects i ... i + kObjects - 1 that a plane rejects.
template <const auto& kOrder, size_t kPlane, size_t kObjects, class D, class V>
HWY_INLINE uint64_t PlaneRejects(D d, const float* const* planes, size_t i,
                                 V query) {
  constexpr bench::Plane kTest = bench::kPlaneOf<kOrder, kPlane>;
  constexpr size_t kMins = kTest.is_min ? 1 : 0;
  return KeptBits<kMins, kObjects>(d, LoadAll(), planes + kTest.object, i,
                                   query) ^
         kLowBits<kObjects>;
}

// A batch that is part of a word: planes kPlane, kPlane + 1, ... until all its
// objects are rejected.
template <const auto& kOrder, size_t kWidth, size_t kPlane = 0, class D,
          class V, class... Rest>
HWY_INLINE uint64_t BatchInWord(D d, const float* const* planes, size_t i,
                                V query, Rest... rest) {
  const uint64_t bits =
      PlaneRejects<kOrder, kPlane, kWidth>(d, planes, i, query);
  if constexpr (sizeof...(Rest) == 0) {
    return bits;
  } else {
    if (bits == kLowBits<kWidth>) return bits;
    return bits |
           BatchInWord<kOrder, kWidth, kPlane + 1>(d, planes, i, rest...);
  }
}

template <const auto& kOrder, size_t kWidth, class D, class... V>
HWY_INLINE void ScanInWords(D d, const float* const* planes, size_t size,
                            uint64_t* mask, V... query) {
  // A batch is never less than a vector.
  if constexpr (kWidth < (HWY_HAVE_SCALABLE ? 4 : hn::MaxLanes(D()))) {
    return;
  } else {
    for (size_t i = 0; i < size; i += kWordObjects) {
      uint64_t word = 0;
      for (size_t l = 0; l < kWordObjects; l += kWidth) {
        word |= BatchInWord<kOrder, kWidth>(d, planes, i + l, query...) << l;
      }
      mask[i / kWordObjects] = word;
    }
  }
}

// One plane of a batch of words; true if all objects are rejected after it.
template <const auto& kOrder, size_t kPlane, class D, class V>
HWY_INLINE bool PlaneOverWords(D d, const float* const* planes, size_t i,
                               size_t words, uint64_t* mask, V query) {
  uint64_t all = ~uint64_t{0};
  for (size_t w = 0; w < words; ++w) {
    uint64_t bits = PlaneRejects<kOrder, kPlane, kWordObjects>(
        d, planes, i + w * kWordObjects, query);
    if constexpr (kPlane != 0) bits |= mask[w];
    mask[w] = bits;
    all &= bits;
  }
  return all == ~uint64_t{0};
}

template <const auto& kOrder, size_t... kPlane, class D, class... V>
HWY_INLINE void ScanOverWords(std::index_sequence<kPlane...>, D d, size_t width,
                              const float* const* planes, size_t size,
                              uint64_t* mask, V... query) {
  const size_t words = width / kWordObjects;
  for (size_t i = 0; i < size; i += width) {
    uint64_t* batch = mask + i / kWordObjects;
    (void)(PlaneOverWords<kOrder, kPlane>(d, planes, i, words, batch, query) ||
           ...);
  }
}

template <const auto& kOrder, size_t... kPlane>
void ScanShape(std::index_sequence<kPlane...> all_planes, size_t width,
               const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  const WordTag<float> d;
#define HALFSPACE_QUERY \
  hn::Set(d, query[bench::kPlaneOf<kOrder, kPlane>.query])...
  switch (width) {
    case 1:
      return ScanInWords<kOrder, 1>(d, planes, size, mask, HALFSPACE_QUERY);
    case 2:
      return ScanInWords<kOrder, 2>(d, planes, size, mask, HALFSPACE_QUERY);
    case 4:
      return ScanInWords<kOrder, 4>(d, planes, size, mask, HALFSPACE_QUERY);
    case 8:
      return ScanInWords<kOrder, 8>(d, planes, size, mask, HALFSPACE_QUERY);
    case 16:
      return ScanInWords<kOrder, 16>(d, planes, size, mask, HALFSPACE_QUERY);
    case 32:
      return ScanInWords<kOrder, 32>(d, planes, size, mask, HALFSPACE_QUERY);
    case 64:
      return ScanInWords<kOrder, 64>(d, planes, size, mask, HALFSPACE_QUERY);
    default:
      return ScanOverWords<kOrder>(all_planes, d, width, planes, size, mask,
                                   HALFSPACE_QUERY);
  }
#undef HALFSPACE_QUERY
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
