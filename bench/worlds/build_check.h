// Whether a bulk builder is right, before it is timed.
#ifndef HALFSPACE_BENCH_WORLDS_BUILD_CHECK_H_
#define HALFSPACE_BENCH_WORLDS_BUILD_CHECK_H_

#include <string>

#include "bench/worlds/build_source.h"
#include "halfspace/fit_many.h"

namespace halfspace::bench {

// Builds with these options. Empty if the bounds of some objects enclose those
// of fit.h and are equal to them in X, Y and Z; else what is wrong.
std::string CheckBuild(const BuildSource& source, const FitOptions& options);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_BUILD_CHECK_H_
