// The bulk builders of all targets of this build.
#ifndef HALFSPACE_DISPATCH_REGISTRY_H_
#define HALFSPACE_DISPATCH_REGISTRY_H_

#include <string_view>

#include "dispatch/fit_table.h"
#include "halfspace/targets.h"

namespace halfspace::dispatch {

// The kernels of a target in `dims` dimensions, the chosen one for a default
// handle. Throws std::invalid_argument, in the name of `call`, if the target is
// not supported here or the choice failed.
const FitTable& FitKernelsFor(Target target, int dims, std::string_view call);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_REGISTRY_H_
