// What a kernel is to do, without types. No Highway here, so that everything
// above the kernels compiles without it.
#ifndef HALFSPACE_KERNELS_MASK_JOB_H_
#define HALFSPACE_KERNELS_MASK_JOB_H_

#include <cstddef>
#include <cstdint>

namespace halfspace::kernels {

inline constexpr std::size_t kPlaneAlignment = 64;

// Planes of no more bytes are in the first levels of any cache.
inline constexpr std::size_t kNearBytes = 128 * 1024;

// Planes and queries in the order of detail::Scan, of the element type that the
// kernel is for; the queries lie one after another.
struct MaskJob {
  const void* const* planes;
  const void* queries;
  std::size_t query_count;

  // Objects begin ... end - 1. `begin` is a multiple of 64.
  std::size_t begin;
  std::size_t end;

  // The word of object `begin` for the first query, and the words from one
  // query's row to the next. `flip` is 0 for reject masks, ~0 for survivor
  // masks.
  std::uint64_t* rows;
  std::size_t stride;
  std::uint64_t flip;

  // Whether the planes of the call are more than kNearBytes; those of a tile
  // that many queries share are near.
  bool is_far;

  // Whether every plane begins at a multiple of kPlaneAlignment bytes.
  bool is_aligned;
};

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_MASK_JOB_H_
