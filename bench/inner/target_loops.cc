#include "bench/inner/target_loops.h"

#include "bench/inner/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/inner/target_loops.cc"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using MemoryTag = hn::CappedTag<uint32_t, 64>;
using Words = hn::Vec<MemoryTag>;

HWY_INLINE Words OrAt(Words before, const void* from, size_t bytes) {
  const void* at = static_cast<const uint8_t*>(from) + bytes;
  return hn::Or(before,
                hn::LoadU(MemoryTag(), static_cast<const uint32_t*>(at)));
}

// Four ORs in turn, so that they are no chain.
HWY_INLINE void ReadChunk(const void* from, Words& a, Words& b, Words& c,
                          Words& e) {
  const size_t vector = 4 * hn::Lanes(MemoryTag());
  size_t l = 0;
  for (; l + 4 * vector <= bench::kReadBytes; l += 4 * vector) {
    a = OrAt(a, from, l);
    b = OrAt(b, from, l + vector);
    c = OrAt(c, from, l + 2 * vector);
    e = OrAt(e, from, l + 3 * vector);
  }
  for (; l < bench::kReadBytes; l += vector) a = OrAt(a, from, l);
}

uint32_t ReadPlanes(size_t turn, const float* const* planes, size_t plane_count,
                    size_t bytes) {
  auto a = hn::Zero(MemoryTag()), b = a, c = a, e = a;
  constexpr size_t kFloats = bench::kReadBytes / sizeof(float);
  const size_t floats = bytes / sizeof(float);
  for (size_t begin = 0; begin < floats; begin += turn / sizeof(float)) {
    const size_t end = HWY_MIN(floats, begin + turn / sizeof(float));
    for (size_t p = 0; p < plane_count; ++p) {
      for (size_t i = begin; i < end; i += kFloats) {
        ReadChunk(planes[p] + i, a, b, c, e);
      }
    }
  }
  const auto all = hn::Or(hn::Or(a, b), hn::Or(c, e));
  return hn::GetLane(hn::MaxOfLanes(MemoryTag(), all));
}

void CopyLines(bool streamed, const uint32_t* from, uint32_t* to,
               size_t count) {
  const MemoryTag d;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const Words words = hn::LoadU(d, from + i);
    if (streamed) {
      hn::Stream(words, d, to + i);
    } else {
      hn::StoreU(words, d, to + i);
    }
  }
  if (streamed) hwy::FlushStream();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

template <std::int64_t kTarget>
TargetLoops LoopsOf();

template <>
TargetLoops LoopsOf<HWY_TARGET>() {
  return {.read = &HWY_NAMESPACE::ReadPlanes,
          .copy = &HWY_NAMESPACE::CopyLines};
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {

TargetLoops LoopsFor(Target target) {
  return FunctionOf<TargetLoops>(target, [](auto t) { return LoopsOf<t()>(); });
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
