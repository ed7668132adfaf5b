#include "bench/gated_scan.h"

#include "bench/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/gated_scan.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what it is compiled for.
#include "kernels/reject-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// A batch that is part of a word: planes kPlane, kPlane + 1, ... until all its
// objects are rejected.
template <class Shape, size_t kWidth, size_t kPlane = 0, class D, class... V>
HWY_INLINE uint64_t BatchInWord(D d, const float* const* planes, size_t i,
                                V... query) {
  constexpr uint64_t kAll = ~uint64_t{0} >> (kWordObjects - kWidth);
  const uint64_t bits = BitsRejected<Shape, kWidth, kPlane, kPlane + 1>(
      d, LoadAll(), planes, i, query...);
  if constexpr (kPlane + 1 == Shape::kOrder.planes.size()) {
    return bits;
  } else {
    if (bits == kAll) return bits;
    return bits |
           BatchInWord<Shape, kWidth, kPlane + 1>(d, planes, i, query...);
  }
}

template <class Shape, size_t kWidth, class D, class... V>
HWY_INLINE void ScanInWords(D d, const float* const* planes, size_t size,
                            uint64_t* mask, V... query) {
  // A batch is never less than a vector.
  if constexpr (kWidth < (HWY_HAVE_SCALABLE ? 4 : hn::MaxLanes(D()))) {
    return;
  } else {
    for (size_t i = 0; i < size; i += kWordObjects) {
      uint64_t word = 0;
      for (size_t l = 0; l < kWordObjects; l += kWidth) {
        word |= BatchInWord<Shape, kWidth>(d, planes, i + l, query...) << l;
      }
      mask[i / kWordObjects] = word;
    }
  }
}

// One plane of a batch of words; true if all objects are rejected after it.
template <class Shape, size_t kPlane, class D, class... V>
HWY_INLINE bool PlaneOverWords(D d, const float* const* planes, size_t i,
                               size_t words, uint64_t* mask, V... query) {
  uint64_t all = ~uint64_t{0};
  for (size_t w = 0; w < words; ++w) {
    uint64_t bits = BitsRejected<Shape, kWordObjects, kPlane, kPlane + 1>(
        d, LoadAll(), planes, i + w * kWordObjects, query...);
    if constexpr (kPlane != 0) bits |= mask[w];
    mask[w] = bits;
    all &= bits;
  }
  return all == ~uint64_t{0};
}

template <class Shape, size_t... kPlane, class D, class... V>
HWY_INLINE void ScanOverWords(std::index_sequence<kPlane...>, D d, size_t width,
                              const float* const* planes, size_t size,
                              uint64_t* mask, V... query) {
  const size_t words = width / kWordObjects;
  for (size_t i = 0; i < size; i += width) {
    uint64_t* batch = mask + i / kWordObjects;
    (void)(PlaneOverWords<Shape, kPlane>(d, planes, i, words, batch,
                                         query...) ||
           ...);
  }
}

template <class Shape, size_t... kPlane>
void ScanShape(std::index_sequence<kPlane...> all_planes, size_t width,
               const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  const WordTag<float> d;
#define HALFSPACE_QUERY \
  hn::Set(d, query[kernels::kQueryIndex<Shape, kPlane>])...
  switch (width) {
    case 1:
      return ScanInWords<Shape, 1>(d, planes, size, mask, HALFSPACE_QUERY);
    case 2:
      return ScanInWords<Shape, 2>(d, planes, size, mask, HALFSPACE_QUERY);
    case 4:
      return ScanInWords<Shape, 4>(d, planes, size, mask, HALFSPACE_QUERY);
    case 8:
      return ScanInWords<Shape, 8>(d, planes, size, mask, HALFSPACE_QUERY);
    case 16:
      return ScanInWords<Shape, 16>(d, planes, size, mask, HALFSPACE_QUERY);
    case 32:
      return ScanInWords<Shape, 32>(d, planes, size, mask, HALFSPACE_QUERY);
    case 64:
      return ScanInWords<Shape, 64>(d, planes, size, mask, HALFSPACE_QUERY);
    default:
      return ScanOverWords<Shape>(all_planes, d, width, planes, size, mask,
                                  HALFSPACE_QUERY);
  }
#undef HALFSPACE_QUERY
}

template <class Shape>
void ScanShape(size_t width, const float* const* planes, const float* query,
               size_t size, uint64_t* mask) {
  ScanShape<Shape>(std::make_index_sequence<Shape::kOrder.planes.size()>(),
                   width, planes, query, size, mask);
}

void ScanGated(bench::GatedShape shape, size_t width,
               const float* const* planes, const float* query, size_t size,
               uint64_t* mask) {
  switch (shape) {
    case bench::GatedShape::kSimplex:
      return ScanShape<kernels::SimplexFlat<3>>(width, planes, query, size,
                                                mask);
    case bench::GatedShape::kAabb:
      return ScanShape<kernels::AabbFlat<3>>(width, planes, query, size, mask);
    case bench::GatedShape::kAabo:
      return ScanShape<kernels::AaboFlat<3>>(width, planes, query, size, mask);
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
