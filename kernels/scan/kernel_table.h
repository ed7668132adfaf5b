// The arguments of a kernel, and the table of kernels. No Highway here, so that
// everything above the kernels compiles without it.
#ifndef HALFSPACE_KERNELS_SCAN_KERNEL_TABLE_H_
#define HALFSPACE_KERNELS_SCAN_KERNEL_TABLE_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/scan.h"

namespace halfspace::detail {

// So many objects are tested for half-spaces by a MaskKernel.
inline constexpr std::size_t kFewObjects = 512;

// The most queries of a chunk: a batch.
inline constexpr std::size_t kMostQueries = 16;

// Some queries of a scan, some of its objects, and where the words of survivors
// are written.
struct Chunk {
  std::size_t first_query;
  std::size_t query_count;
  const void* queries;  // the values of the first, of the type of the planes

  std::size_t begin;  // objects begin ... end - 1
  std::size_t end;

  // Bit 0 of row 0 is object `begin` and query `first_query`; nothing past
  // `end` survives.
  std::uint64_t* rows;
  std::size_t stride;  // words from one row to the next
};

// Returns the Highway bit of the target that it was compiled for, so that tests
// can tell which one runs.
using Kernel = std::int64_t (*)(const Scan& scan, const Chunk& chunk);

// Writes the words of survivors of `count` objects from `begin` on. `planes`
// are those of a view, `query` is one of its queries. Nothing past the last
// object survives.
using MaskKernel = void (*)(const void* planes, std::size_t begin,
                            std::size_t count, const void* query,
                            std::uint64_t* words) noexcept;

struct TargetKernels {
  Kernel run[kScanKernels];
  // By Scan::is_wide: with AVX-512 the second uses vectors of 512 bits. On
  // other targets both are the same.
  MaskKernel mask_of_minima[2];  // of a simplex
  MaskKernel mask_of_all[2];     // of the other shapes
  // Up to so many objects mask_of_all is the fastest: boxes, octahedra.
  std::size_t few_objects;
  std::size_t few_octahedra;

  // Which of at most 64 words are not 0, and how many bits these have.
  std::uint64_t (*nonzero_words)(const std::uint64_t* words, std::size_t count);
  std::size_t (*count_bits)(const std::uint64_t* words, std::uint64_t nonzero);
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_SCAN_KERNEL_TABLE_H_
