// What each per-target pass defines: one specialisation per target and number
// of dimensions.
#ifndef HALFSPACE_DISPATCH_TARGET_TABLE_H_
#define HALFSPACE_DISPATCH_TARGET_TABLE_H_

#include <cstddef>
#include <cstdint>

#include "dispatch/fit_table.h"

namespace halfspace::dispatch {

// The bulk builders of a target; defined in fit_kernels_2d.cc and so on.
template <std::int64_t kHighwayBit, int kDims>
const FitTable& FitTableOf();

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TARGET_TABLE_H_
