// Bounds of many shapes of doubles: those of fit.h, one after the other.
#ifndef HALFSPACE_DISPATCH_FIT_ONE_BY_ONE_H_
#define HALFSPACE_DISPATCH_FIT_ONE_BY_ONE_H_

#include <cstddef>

#include "halfspace/bounds.h"
#include "halfspace/detail/bulk.h"
#include "halfspace/shapes.h"
#include "kernels/fit_many/kernel_table.h"

namespace halfspace::detail {

// Numbers of element i, from column `first` on.
template <int kDims>
Point<kDims, double> ElementAt(const kernels::FitJob& job, std::size_t i,
                               std::size_t first = 0) {
  Point<kDims, double> point;
  for (std::size_t k = 0; k < kDims; ++k) {
    point[k] = job.columns.doubles(first + k)[i * job.columns.stride];
  }
  return point;
}

// Writes bound_of(i) for every shape i.
template <int kDims, typename BoundOf>
kernels::FitTally FitEach(const kernels::FitJob& job, const BoundOf& bound_of) {
  kernels::FitTally tally;
  for (std::size_t i = 0; i < job.size; ++i) {
    const Aabo<kDims> bound = bound_of(i);
    if (bound == Aabo<kDims>::Everything()) tally.Count(1, i);
    for (std::size_t k = 0; k <= kDims; ++k) {
      float* const min = job.planes[k];
      float* const max = job.planes[kDims + 1 + k];
      if (min != nullptr) min[i] = bound.min[k];
      if (max != nullptr) max[i] = bound.max[k];
    }
  }
  return tally;
}

template <kernels::FitTally (*kFit)(const kernels::FitJob&)>
constexpr FitKernels kOneByOne = {kFit, kFit};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_FIT_ONE_BY_ONE_H_
