#include "bench/plane_reader.h"

#include <cwchar>
#include <stdexcept>

#include "bench/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/plane_reader.cc"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

namespace halfspace::bench {

// Outside the per-target code: the C library chooses its own.
std::uint32_t ReadWithLibrary(const unsigned char* const* planes,
                              std::size_t plane_count, std::size_t bytes);
[[noreturn]] void ThrowPlaneCount();

}  // namespace halfspace::bench

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using ReadTag = hn::CappedTag<uint32_t, 64>;
using bench::kReadBytes;

inline constexpr size_t kPage = 4096;
// Beyond what the hardware's prefetchers hold of one stream.
inline constexpr size_t kAhead = 2048;

using V = hn::Vec<ReadTag>;

HWY_INLINE V OrAt(V before, const uint8_t* from) {
  const ReadTag d;
  return hn::Or(before, hn::LoadU(d, reinterpret_cast<const uint32_t*>(from)));
}

// Four ORs in turn, so that they are no chain.
HWY_INLINE void ReadChunk(const uint8_t* from, V& a, V& b, V& c, V& e) {
  const size_t vector = 4 * hn::Lanes(ReadTag());
  size_t l = 0;
  for (; l + 4 * vector <= kReadBytes; l += 4 * vector) {
    a = OrAt(a, from + l);
    b = OrAt(b, from + l + vector);
    c = OrAt(c, from + l + 2 * vector);
    e = OrAt(e, from + l + 3 * vector);
  }
  for (; l < kReadBytes; l += vector) a = OrAt(a, from + l);
}

// The chunk at `i` of a plane; prefetches the one that is kAhead behind it.
template <bool kPrefetch>
HWY_INLINE void ReadChunkOf(const uint8_t* plane, size_t bytes, size_t i, V& a,
                            V& b, V& c, V& e) {
  if constexpr (kPrefetch) {
    const uint8_t* next = plane + HWY_MIN(i + kAhead, bytes - kReadBytes);
    for (size_t l = 0; l < kReadBytes; l += 64) {
      hwy::Prefetch(next + l);
    }
  }
  ReadChunk(plane + i, a, b, c, e);
}

HWY_INLINE uint32_t Fold(V a, V b, V c, V e) {
  const ReadTag d;
  const V all = hn::Or(hn::Or(a, b), hn::Or(c, e));
  HWY_ALIGN uint32_t words[kReadBytes / 4];
  hn::Store(all, d, words);
  uint32_t folded = 0;
  for (size_t l = 0; l < hn::Lanes(d); ++l) folded |= words[l];
  return folded;
}

template <bool kPrefetch, size_t... kPlane>
uint32_t ReadByPlane(std::index_sequence<kPlane...>,
                     const uint8_t* const* planes, size_t bytes) {
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  for (size_t p = 0; p < sizeof...(kPlane); ++p) {
    for (size_t i = 0; i < bytes; i += kReadBytes) {
      ReadChunkOf<kPrefetch>(planes[p], bytes, i, a, b, c, e);
    }
  }
  return Fold(a, b, c, e);
}

template <size_t... kPlane>
uint32_t ReadByHalves(std::index_sequence<kPlane...>,
                      const uint8_t* const* planes, size_t bytes) {
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  const size_t half = bytes / (2 * kReadBytes) * kReadBytes;
  for (size_t p = 0; p < sizeof...(kPlane); ++p) {
    for (size_t i = 0; i < half; i += kReadBytes) {
      ReadChunk(planes[p] + i, a, b, c, e);
      ReadChunk(planes[p] + half + i, a, b, c, e);
    }
    for (size_t i = 2 * half; i < bytes; i += kReadBytes) {
      ReadChunk(planes[p] + i, a, b, c, e);
    }
  }
  return Fold(a, b, c, e);
}

// So many bytes of each plane in turn.
template <bool kPrefetch, size_t kTurn, size_t... kPlane>
uint32_t ReadInTurn(std::index_sequence<kPlane...>,
                    const uint8_t* const* planes, size_t bytes) {
  const uint8_t* const local[] = {planes[kPlane]...};
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  size_t i = 0;
  for (; i + kTurn <= bytes; i += kTurn) {
    if constexpr (kTurn == kReadBytes) {
      (ReadChunkOf<kPrefetch>(local[kPlane], bytes, i, a, b, c, e), ...);
    } else {
      for (const uint8_t* plane : local) {
        for (size_t l = 0; l < kTurn; l += kReadBytes) {
          ReadChunk(plane + i + l, a, b, c, e);
        }
      }
    }
  }
  for (; i < bytes; i += kReadBytes) {
    (ReadChunk(local[kPlane] + i, a, b, c, e), ...);
  }
  return Fold(a, b, c, e);
}

template <size_t kPlanes>
uint32_t ReadSome(bench::ReadWay way, const uint8_t* const* planes,
                  size_t bytes) {
  using bench::ReadWay;
  constexpr std::make_index_sequence<kPlanes> kAll{};
  switch (way) {
    case ReadWay::kByPlane:
      return ReadByPlane<false>(kAll, planes, bytes);
    case ReadWay::kByPlanePrefetched:
      return ReadByPlane<true>(kAll, planes, bytes);
    case ReadWay::kByHalves:
      return ReadByHalves(kAll, planes, bytes);
    case ReadWay::kByWord:
      return ReadInTurn<false, kReadBytes>(kAll, planes, bytes);
    case ReadWay::kByWordPrefetched:
      return ReadInTurn<true, kReadBytes>(kAll, planes, bytes);
    case ReadWay::kByPage:
      return ReadInTurn<false, kPage>(kAll, planes, bytes);
    case ReadWay::kWmemchr:
      break;
  }
  return bench::ReadWithLibrary(planes, kPlanes, bytes);
}

uint32_t ReadPlanes(bench::ReadWay way, const uint8_t* const* planes,
                    size_t plane_count, size_t bytes) {
  if (plane_count == 4) return ReadSome<4>(way, planes, bytes);
  if (plane_count == 6) return ReadSome<6>(way, planes, bytes);
  if (plane_count == 8) return ReadSome<8>(way, planes, bytes);
  bench::ThrowPlaneCount();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
PlaneReader PlaneReaderOf();

template <>
PlaneReader PlaneReaderOf<HWY_TARGET>() {
  return &HWY_NAMESPACE::ReadPlanes;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

std::uint32_t ReadWithLibrary(const unsigned char* const* planes,
                              std::size_t plane_count, std::size_t bytes) {
  const auto absent = static_cast<wchar_t>(kAbsent);
  std::uint32_t found = 0;
  for (std::size_t p = 0; p < plane_count; ++p) {
    const auto* from = reinterpret_cast<const wchar_t*>(planes[p]);
    const auto* const end = from + bytes / sizeof(wchar_t);
    while ((from = std::wmemchr(from, absent,
                                static_cast<std::size_t>(end - from)))) {
      ++from;
      ++found;
    }
  }
  return found;
}

void ThrowPlaneCount() {
  throw std::logic_error("ReadPlanes: neither 4 nor 6 nor 8 planes");
}

PlaneReader PlaneReaderFor(Target target) {
  return FunctionOf<PlaneReader>(target,
                                 [](auto t) { return PlaneReaderOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
