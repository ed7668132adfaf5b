// Reads planes and does nothing else: the ceiling of a kernel whose world
// streams from memory.
#ifndef HALFSPACE_BENCH_BASELINES_PLANE_READER_H_
#define HALFSPACE_BENCH_BASELINES_PLANE_READER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "halfspace/targets.h"

namespace halfspace::bench {

enum class ReadWay : std::size_t {
  kByPlane,           // one plane after the other
  kByHalves,          // one plane after the other, as two streams
  kByWord,            // 256 bytes of each plane in turn, as a flat kernel
  kByWordPrefetched,  // the same, with software prefetch
  kByPage,            // 4 KiB of each plane in turn
  kByTwoPages,        // 8 KiB
  kWmemchr,           // the C library's search for a value that is not there
};

inline constexpr std::array<ReadWay, 7> kReadWays = {
    ReadWay::kByPlane,          ReadWay::kByHalves, ReadWay::kByWord,
    ReadWay::kByWordPrefetched, ReadWay::kByPage,   ReadWay::kByTwoPages,
    ReadWay::kWmemchr};

constexpr const char* NameOf(ReadWay way) {
  constexpr const char* kNames[] = {
      "by-plane", "by-halves",    "by-word", "by-word-prefetched",
      "by-page",  "by-two-pages", "wmemchr"};
  return kNames[static_cast<std::size_t>(way)];
}

// Memory to be read: planes of the same length.
using BytePlanes = std::vector<const unsigned char*>;

template <typename T>
BytePlanes BytesOf(const std::vector<const T*>& planes) {
  BytePlanes bytes;
  for (const T* plane : planes) {
    bytes.push_back(reinterpret_cast<const unsigned char*>(plane));
  }
  return bytes;
}

// What is read must be a multiple of this.
inline constexpr std::size_t kReadBytes = 256;

// What wmemchr looks for, as no plane has it: as a float, a signalling NaN.
inline constexpr std::uint32_t kAbsent = 0x7f9badca;

// Reads `bytes` of each of 4, 6 or 8 planes. The result depends on every byte,
// so that no read can be left out: all words ORed, or, of kWmemchr, how often
// kAbsent was found.
using PlaneReader = std::uint32_t (*)(ReadWay way,
                                      const unsigned char* const* planes,
                                      std::size_t plane_count,
                                      std::size_t bytes);

// Of a supported target. Throws std::logic_error for other numbers of planes.
PlaneReader PlaneReaderFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_PLANE_READER_H_
