// What each per-target pass defines: one specialisation per target and, for the
// kernels, per number of dimensions.
#ifndef HALFSPACE_DISPATCH_TARGET_TABLE_H_
#define HALFSPACE_DISPATCH_TARGET_TABLE_H_

#include <cstddef>
#include <cstdint>

#include "dispatch/fit_table.h"
#include "dispatch/kernel_table.h"

namespace halfspace::dispatch {

// The kernels of target kHighwayBit; defined in kernels_2d.cc and so on.
template <std::int64_t kHighwayBit, int kDims>
const KernelTable& TableOf();

// Its bulk builders; defined in fit_kernels_2d.cc and so on.
template <std::int64_t kHighwayBit, int kDims>
const FitTable& FitTableOf();

// float32 lanes of a vector; executes an instruction of that target.
template <std::int64_t kHighwayBit>
std::size_t LanesOf();

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_TARGET_TABLE_H_
