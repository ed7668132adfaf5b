// What a kernel is to do, without types. No Highway here, so that everything
// above the kernels compiles without it.
#ifndef HALFSPACE_KERNELS_MASK_JOB_H_
#define HALFSPACE_KERNELS_MASK_JOB_H_

#include <cstddef>
#include <cstdint>

namespace halfspace::kernels {

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

  // Whether planes may be out of the caches: those of a tile that many queries
  // share are not.
  bool is_far;
};

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_MASK_JOB_H_
