// The bulk builders of a target, as plain function pointers.
#ifndef HALFSPACE_DISPATCH_FIT_TABLE_H_
#define HALFSPACE_DISPATCH_FIT_TABLE_H_

#include <array>
#include <cstddef>

#include "kernels/fit_job.h"

namespace halfspace::dispatch {

using FitKernel = kernels::FitTally (*)(const kernels::FitJob& job);

// One kind of source: D within an ulp, and tightest.
struct FitKernels {
  FitKernel within_ulp;
  FitKernel tightest;
};

enum FitSource : std::size_t {
  kFitBoxes,
  kFitSpheres,
  kFitTriangles,
  kFitPointSets,
  kFitSources
};

using FitTable = std::array<FitKernels, kFitSources>;

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_FIT_TABLE_H_
