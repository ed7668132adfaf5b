// The search of bvh_pairs.h, for any use of what it finds.
#ifndef HALFSPACE_DISPATCH_BVH_PAIRS_H_
#define HALFSPACE_DISPATCH_BVH_PAIRS_H_

#include "halfspace/bvh_pairs.h"
#include "halfspace/detail/bvh.h"
#include "kernels/results.h"

namespace halfspace::detail {

// Checks the arguments, in the name of `call`, and writes the pairs.
// `options.skip` is not read.
void FindPairs(const PairSources& sources, const PairOptions& options,
               const char* call, Results<IdPair>& pairs);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_PAIRS_H_
