// Loops that are compiled for each target as the library's kernels are: the
// ceilings that scans and builders are measured by.
#ifndef HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_
#define HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/targets.h"

namespace halfspace::bench {

// What is read or copied must be a multiple of so many bytes, or objects.
inline constexpr std::size_t kReadBytes = 256;
inline constexpr std::size_t kCopyObjects = 128;

// Arrays that describe the same objects in the same order. An object has an
// even number of bytes in each; those to be written are aligned to 64 bytes.
struct CopyJob {
  template <typename Byte>
  struct Stream {
    Byte* begin;
    std::size_t object_bytes;
  };
  std::size_t objects = 0;
  std::vector<Stream<const unsigned char>> reads = {};
  std::vector<Stream<unsigned char>> writes = {};
};

struct TargetLoops {
  // Of the vectors that test floats for one query in the library.
  std::size_t (*one_query_lanes)() = nullptr;

  // Reads `bytes` of each plane: 256 bytes of each in turn, as a flat kernel,
  // or, with `by_plane`, one plane after the other. Returns all words ORed, so
  // that no read can be left out.
  std::uint32_t (*read)(bool by_plane, const float* const* planes,
                        std::size_t plane_count, std::size_t bytes) = nullptr;

  // Reads every byte of a job once and writes every byte once, 128 objects at a
  // time, as a builder; `streamed` stores past the caches. What is written is
  // the OR of what has been read before.
  void (*copy)(bool streamed, const CopyJob& job) = nullptr;
};

// Of a supported target.
TargetLoops LoopsFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INNER_TARGET_LOOPS_H_
