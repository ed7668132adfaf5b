// The arguments of a bulk builder, what it reports, and the table of builders.
// No Highway here.
#ifndef HALFSPACE_KERNELS_FIT_MANY_KERNEL_TABLE_H_
#define HALFSPACE_KERNELS_FIT_MANY_KERNEL_TABLE_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/fit_many.h"

namespace halfspace::kernels {

// The columns are those of a detail::Source. The bounds of `size` shapes go to
// the planes of an Aabo that are not null.
struct FitJob {
  const detail::Columns& columns;
  float* const* planes;
  std::size_t size;
  const std::uint32_t* indices;  // triangles: three for each
  const std::size_t* ends;       // point sets: one for each
  bool inverted_is_empty;        // boxes
};

struct FitTally {
  std::size_t everything = 0;
  std::size_t first_everything = 0;
  std::int64_t target = 0;  // the Highway bit of what ran

  void Count(std::size_t how_many, std::size_t first) {
    if (everything == 0) first_everything = first;
    everything += how_many;
  }
};

}  // namespace halfspace::kernels

namespace halfspace::detail {

// One source on one target.
struct FitKernels {
  kernels::FitTally (*fit)(const kernels::FitJob& job);
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_FIT_MANY_KERNEL_TABLE_H_
