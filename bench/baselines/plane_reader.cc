#include "bench/baselines/plane_reader.h"

#include <cwchar>
#include <stdexcept>
#include <utility>

#include "bench/base/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/baselines/plane_reader.cc"
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
// Of 512 to 8192 bytes the fastest in L3 and memory, on Zen 4.
inline constexpr size_t kAhead = 512;

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

HWY_INLINE uint32_t Fold(V a, V b, V c, V e) {
  const ReadTag d;
  const V all = hn::Or(hn::Or(a, b), hn::Or(c, e));
  HWY_ALIGN uint32_t words[kReadBytes / 4];
  hn::Store(all, d, words);
  uint32_t folded = 0;
  for (size_t l = 0; l < hn::Lanes(d); ++l) folded |= words[l];
  return folded;
}

uint32_t ReadByPlane(const uint8_t* const* planes, size_t plane_count,
                     size_t bytes) {
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  for (size_t p = 0; p < plane_count; ++p) {
    for (size_t i = 0; i < bytes; i += kReadBytes) {
      ReadChunk(planes[p] + i, a, b, c, e);
    }
  }
  return Fold(a, b, c, e);
}

uint32_t ReadByHalves(const uint8_t* const* planes, size_t plane_count,
                      size_t bytes) {
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  const size_t half = bytes / (2 * kReadBytes) * kReadBytes;
  for (size_t p = 0; p < plane_count; ++p) {
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

// The chunks of all planes at `i`.
template <bool kPrefetch, size_t... kPlane>
HWY_INLINE void ReadChunks(const uint8_t* const (&planes)[sizeof...(kPlane)],
                           size_t bytes, size_t i, V& a, V& b, V& c, V& e) {
  if constexpr (kPrefetch) {
    const size_t next = HWY_MIN(i + kAhead, bytes - kReadBytes);
    for (size_t l = 0; l < kReadBytes; l += 64) {
      (hwy::Prefetch(planes[kPlane] + next + l), ...);
    }
  }
  (ReadChunk(planes[kPlane] + i, a, b, c, e), ...);
}

template <bool kPrefetch, size_t... kPlane>
uint32_t ReadByWord(std::index_sequence<kPlane...>,
                    const uint8_t* const* planes, size_t bytes) {
  const uint8_t* const local[] = {planes[kPlane]...};
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  for (size_t i = 0; i < bytes; i += kReadBytes) {
    ReadChunks<kPrefetch, kPlane...>(local, bytes, i, a, b, c, e);
  }
  return Fold(a, b, c, e);
}

uint32_t ReadInTurn(const uint8_t* const* planes, size_t plane_count,
                    size_t bytes, size_t turn) {
  V a = hn::Zero(ReadTag()), b = a, c = a, e = a;
  for (size_t begin = 0; begin < bytes; begin += turn) {
    const size_t end = HWY_MIN(begin + turn, bytes);
    for (size_t p = 0; p < plane_count; ++p) {
      for (size_t i = begin; i < end; i += kReadBytes) {
        ReadChunk(planes[p] + i, a, b, c, e);
      }
    }
  }
  return Fold(a, b, c, e);
}

template <bool kPrefetch>
uint32_t ReadWords(const uint8_t* const* planes, size_t plane_count,
                   size_t bytes) {
  constexpr std::make_index_sequence<4> kFour{};
  constexpr std::make_index_sequence<6> kSix{};
  constexpr std::make_index_sequence<8> kEight{};
  if (plane_count == 4) return ReadByWord<kPrefetch>(kFour, planes, bytes);
  if (plane_count == 6) return ReadByWord<kPrefetch>(kSix, planes, bytes);
  if (plane_count == 8) return ReadByWord<kPrefetch>(kEight, planes, bytes);
  bench::ThrowPlaneCount();
}

uint32_t ReadPlanes(bench::ReadWay way, const uint8_t* const* planes,
                    size_t plane_count, size_t bytes) {
  using bench::ReadWay;
  switch (way) {
    case ReadWay::kByPlane:
      return ReadByPlane(planes, plane_count, bytes);
    case ReadWay::kByHalves:
      return ReadByHalves(planes, plane_count, bytes);
    case ReadWay::kByWord:
      return ReadWords<false>(planes, plane_count, bytes);
    case ReadWay::kByWordPrefetched:
      return ReadWords<true>(planes, plane_count, bytes);
    case ReadWay::kByPage:
      return ReadInTurn(planes, plane_count, bytes, kPage);
    case ReadWay::kByTwoPages:
      return ReadInTurn(planes, plane_count, bytes, 2 * kPage);
    case ReadWay::kWmemchr:
      break;
  }
  return bench::ReadWithLibrary(planes, plane_count, bytes);
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
