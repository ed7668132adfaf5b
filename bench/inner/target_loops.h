// Loops that are compiled for each target as the library's kernels are: the
// ceilings that scans and builders are measured by.
#ifndef HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_
#define HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::bench {

// What is read, and a turn, must be a multiple of so many bytes.
inline constexpr std::size_t kReadBytes = 256;

struct TargetLoops {
  // Reads `bytes` of each plane, `turn` bytes of each in turn: a flat kernel
  // takes 256. Returns 0 if all words are, so that no read can be left out.
  std::uint32_t (*read)(std::size_t turn, const float* const* planes,
                        std::size_t plane_count, std::size_t bytes) = nullptr;

  // Copies words, a multiple of 64, to where a cache line begins; `streamed`
  // stores past the caches.
  void (*copy)(bool streamed, const std::uint32_t* from, std::uint32_t* to,
               std::size_t count) = nullptr;
};

// The target must be supported.
TargetLoops LoopsFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_
