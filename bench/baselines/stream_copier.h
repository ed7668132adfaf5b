// Copies memory and does nothing else: the ceiling of a bulk builder that reads
// and writes as much.
#ifndef HALFSPACE_BENCH_BASELINES_STREAM_COPIER_H_
#define HALFSPACE_BENCH_BASELINES_STREAM_COPIER_H_

#include <array>
#include <cstddef>

#include "bench/baselines/copy_job.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

enum class CopyWay : std::size_t {
  kInterleaved,          // 512 bytes of each plane in turn, as a builder does
  kInterleavedStreamed,  // the same with stores past the caches
  kByPlane,              // one plane after the other
  kByPlaneStreamed,
  kMemcpy,  // one plane after the other, 4 KiB at a time
};

inline constexpr std::array<CopyWay, 5> kCopyWays = {
    CopyWay::kInterleaved, CopyWay::kInterleavedStreamed, CopyWay::kByPlane,
    CopyWay::kByPlaneStreamed, CopyWay::kMemcpy};

constexpr const char* NameOf(CopyWay way) {
  constexpr const char* kNames[] = {"interleaved", "interleaved-streamed",
                                    "by-plane", "by-plane-streamed", "memcpy"};
  return kNames[static_cast<std::size_t>(way)];
}

constexpr bool IsStreamed(CopyWay way) {
  return way == CopyWay::kInterleavedStreamed ||
         way == CopyWay::kByPlaneStreamed;
}

// Objects that all streams describe must be a multiple of this, or, to be
// copied with memcpy, of kMemcpyObjects.
inline constexpr std::size_t kCopyObjects = 128;
inline constexpr std::size_t kMemcpyObjects = 2048;

// memcpy cannot drop what is read: it needs at least as much to write.
bool CanCopy(CopyWay way, const CopyJob& job);

// Reads every byte once from memory and writes every byte once, with the
// vectors of a supported target. What is read beyond what is written is joined
// with OR, so that no read can be left out. Planes to be written start on
// 64-byte boundaries.
void CopyStreams(CopyWay way, const CopyJob& job, std::size_t objects,
                 Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_STREAM_COPIER_H_
