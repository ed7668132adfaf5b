// The shape of what a per-target pass leaves behind: plain function pointers.
// No Highway here, so that everything above the kernels compiles without it.
#ifndef HALFSPACE_DISPATCH_KERNEL_TABLE_H_
#define HALFSPACE_DISPATCH_KERNEL_TABLE_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "kernels/mask_job.h"

namespace halfspace::dispatch {

// Shape and schedule, as the kernels see them.
enum Variant : std::size_t {
  kSimplexFlat,
  kSimplexByAxis,
  kAabbFlat,
  kAabbByAxis,
  kAaboFlat,
  kAaboByAxis,
  kAaboBySimplex,
  kAaboUp,  // null but for codes
  kVariants
};

inline constexpr std::size_t kElements = 4;  // of detail::Element

// Returns the Highway bit of the target it was compiled for, so that a result
// can say what really ran.
using MaskKernel = std::int64_t (*)(const kernels::MaskJob& job);

struct KernelTable {
  std::array<std::array<MaskKernel, kVariants>, kElements> mask;

  // Of at most 64 words of survivors: which are not 0, and the survivors in
  // those.
  std::uint64_t (*live_words)(const std::uint64_t* words, std::size_t count);
  std::size_t (*count_survivors)(const std::uint64_t* words,
                                 std::uint64_t live);
};

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_KERNEL_TABLE_H_
