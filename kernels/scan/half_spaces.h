// Half-spaces as the query of a flat scan. No Highway here.
#ifndef HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_
#define HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_

#include "kernels/bvh/shape.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::detail {

// One kernel for any planes of floats, and for every enumerator of ScanKernel.
// Its queries are Fronts.
extern template struct KernelsOfAll<TargetKernels>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_
