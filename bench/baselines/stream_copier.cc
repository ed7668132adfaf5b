#include "bench/baselines/stream_copier.h"

#include <cstring>

#include "bench/base/target_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/baselines/stream_copier.cc"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using CopyTag = hn::CappedTag<uint32_t, 64>;
using CopyVector = hn::Vec<CopyTag>;

inline constexpr size_t kCopyWord = 64;  // uint32_t

// `i` counts in uint32_t.
HWY_INLINE CopyVector LoadWordAt(const unsigned char* word, size_t i) {
  return hn::LoadU(CopyTag(), reinterpret_cast<const uint32_t*>(word) + i);
}

template <bool kStreamed>
HWY_INLINE void StoreWordAt(CopyVector v, unsigned char* word, size_t i) {
  uint32_t* const to = reinterpret_cast<uint32_t*>(word) + i;
  if constexpr (kStreamed) {
    hn::Stream(v, CopyTag(), to);
  } else {
    hn::StoreU(v, CopyTag(), to);
  }
}

// Four vectors at a time, so that long reads go forward.
template <bool kStreamed>
HWY_INLINE void CopyWord(const bench::CopyWalk::Step& step) {
  const size_t lanes = hn::Lanes(CopyTag());
  size_t i = 0;
  for (; i + 4 * lanes <= kCopyWord; i += 4 * lanes) {
    auto a = LoadWordAt(step.from[0], i);
    auto b = LoadWordAt(step.from[0], i + lanes);
    auto c = LoadWordAt(step.from[0], i + 2 * lanes);
    auto e = LoadWordAt(step.from[0], i + 3 * lanes);
    for (size_t r = 1; r < step.reads; ++r) {
      a = hn::Or(a, LoadWordAt(step.from[r], i));
      b = hn::Or(b, LoadWordAt(step.from[r], i + lanes));
      c = hn::Or(c, LoadWordAt(step.from[r], i + 2 * lanes));
      e = hn::Or(e, LoadWordAt(step.from[r], i + 3 * lanes));
    }
    StoreWordAt<kStreamed>(a, step.to, i);
    StoreWordAt<kStreamed>(b, step.to, i + lanes);
    StoreWordAt<kStreamed>(c, step.to, i + 2 * lanes);
    StoreWordAt<kStreamed>(e, step.to, i + 3 * lanes);
  }
  for (; i < kCopyWord; i += lanes) {
    auto a = LoadWordAt(step.from[0], i);
    for (size_t r = 1; r < step.reads; ++r) {
      a = hn::Or(a, LoadWordAt(step.from[r], i));
    }
    StoreWordAt<kStreamed>(a, step.to, i);
  }
}

template <bool kStreamed>
void CopyWords(const bench::CopyJob& job, const bench::CopyOrder& order) {
  bench::CopyWalk walk(job, order, kCopyWord * sizeof(uint32_t));
  for (size_t w = 0; w < walk.steps(); ++w) CopyWord<kStreamed>(walk.Next());
}

void CopyInVectors(bool is_streamed, const bench::CopyJob& job,
                   const bench::CopyOrder& order) {
  if (is_streamed) {
    CopyWords<true>(job, order);
    hwy::FlushStream();
  } else {
    CopyWords<false>(job, order);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

namespace halfspace::bench {

using VectorCopier = void (*)(bool is_streamed, const CopyJob& job,
                              const CopyOrder& order);

template <std::int64_t kTarget>
VectorCopier VectorCopierOf();

template <>
VectorCopier VectorCopierOf<HWY_TARGET>() {
  return &HWY_NAMESPACE::CopyInVectors;
}

}  // namespace halfspace::bench

#if HWY_ONCE
namespace halfspace::bench {
namespace {

void CopyByMemcpy(const CopyJob& job) {
  constexpr std::size_t kBytes = 4096;
  CopyWalk walk(job, CopyOrder(), kBytes);
  for (std::size_t w = 0; w < walk.steps(); ++w) {
    const CopyWalk::Step& step = walk.Next();
    std::memcpy(step.to, step.from[0], kBytes);
  }
}

}  // namespace

bool CanCopy(CopyWay way, const CopyJob& job) {
  return way != CopyWay::kMemcpy || job.reads.bytes() <= job.writes.bytes();
}

void CopyStreams(CopyWay way, const CopyJob& job, std::size_t objects,
                 Target target) {
  if (way == CopyWay::kMemcpy) {
    CopyByMemcpy(job);
    return;
  }
  const bool is_interleaved =
      way == CopyWay::kInterleaved || way == CopyWay::kInterleavedStreamed;
  const CopyOrder order =
      is_interleaved ? CopyOrder{objects / kCopyObjects, 2} : CopyOrder();
  FunctionOf<VectorCopier>(target, [](auto t) {
    return VectorCopierOf<t()>();
  })(IsStreamed(way), job, order);
}

}  // namespace halfspace::bench
#endif  // HWY_ONCE
