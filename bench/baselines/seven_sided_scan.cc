#include "bench/baselines/seven_sided_scan.h"

#include <type_traits>

#include "bench/base/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/baselines/seven_sided_scan.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what it is compiled for.
#include "kernels/scan/stages-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// Up to so many bytes of planes are taken to be in cache, as by the library.
inline constexpr size_t kInCacheBytes = 128 * 1024;
inline constexpr size_t kRecordBytes = 7 * sizeof(float);

// The functions below have names of their own: a kernel that was instantiated
// here again might replace that of the library when the tool is linked.

// Tests the minima of a tile in cache.
HWY_INLINE void TestMinimaOfBoxes(const float* const* planes,
                                  const float* query, size_t word, size_t count,
                                  uint64_t* mask) {
  using LoadPlane = std::conditional_t<kAlignedLoadsPay, LoadAligned, LoadAll>;
  const OneTag<float> d;
  const auto x = hn::Set(d, query[0]);
  const auto y = hn::Set(d, query[1]);
  const auto z = hn::Set(d, query[2]);
  const auto last = hn::Set(d, query[3]);
  for (size_t w = word; w < word + count; ++w) {
    mask[w] =
        KeptBits<4>(d, LoadPlane(), planes, w * kWordObjects, x, y, z, last);
  }
}

// Tests the maxima of those words of a tile that are nonzero.
HWY_INLINE void TestMaximaOfBoxes(const float* const* planes,
                                  const float* query, size_t word,
                                  uint64_t nonzero, uint64_t* mask) {
  const OneTag<float> d;
  const auto x = hn::Set(d, query[4]);
  const auto y = hn::Set(d, query[5]);
  const auto z = hn::Set(d, query[6]);
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = word + hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    mask[w] &= KeptBits<0>(d, LoadAll(), planes + 4, w * kWordObjects, x, y, z);
  }
}

void ScanSevenSided(const float* const* planes, const float* query, size_t size,
                    uint64_t* mask) {
  const float* local[] = {planes[0], planes[1], planes[2], planes[3],
                          planes[4], planes[5], planes[6]};
  // What streams and prefetches takes scans: minima from plane 0 on, and maxima
  // of three axes from plane 3 on.
  detail::Scan minima{};
  detail::Scan maxima{};
  for (size_t k = 0; k < 4; ++k) minima.planes[k] = planes[k];
  for (size_t k = 0; k < 3; ++k) maxima.planes[3 + k] = planes[4 + k];
  minima.axes = 4;
  const bool is_streaming = size * kRecordBytes > kInCacheBytes;
  const size_t words = size / kWordObjects;
  const detail::Part all = {.first_query = 0,
                            .query_count = 1,
                            .queries = query,
                            .begin = 0,
                            .end = size,
                            .rows = mask,
                            .stride = 0};
  // A tile is finished after the minima of the next one, when its maxima have
  // arrived.
  size_t last = 0;
  uint64_t last_nonzero = 0;
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const size_t count = HWY_MIN(kTileWords, words - begin);
    const detail::Part tile =
        PartFrom(all, begin, (begin + count) * kWordObjects);
    if (is_streaming && kPagesPay) {
      StreamPages<false, float>(minima, tile);
    } else {
      TestMinimaOfBoxes(local, query, begin, count, mask);
    }
    const uint64_t nonzero = NonzeroWords(mask + begin, count);
    if (is_streaming) {
      PrefetchMaxima<3, float>(maxima, begin * kWordObjects, nonzero);
    }
    TestMaximaOfBoxes(local, query, last, last_nonzero, mask);
    last = begin;
    last_nonzero = nonzero;
  }
  TestMaximaOfBoxes(local, query, last, last_nonzero, mask);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
SevenSidedScan SevenSidedScanOf();

template <>
SevenSidedScan SevenSidedScanOf<HWY_TARGET>() {
  return &HWY_NAMESPACE::ScanSevenSided;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

SevenSidedScan SevenSidedScanFor(Target target) {
  return FunctionOf<SevenSidedScan>(
      target, [](auto t) { return SevenSidedScanOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
