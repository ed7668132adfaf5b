// What one call of each single-shape builder costs.
#ifndef HALFSPACE_BENCH_SECTIONS_SINGLE_BUILDS_H_
#define HALFSPACE_BENCH_SECTIONS_SINGLE_BUILDS_H_

#include <vector>

#include "bench/measure/measure.h"

namespace halfspace::bench {

// A case for each builder of fit.h and transform.h in 3 dimensions, over random
// shapes; its name is the call's, its items are calls (points for BoundPoints).
std::vector<Case> SingleBuildCases();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SINGLE_BUILDS_H_
