// The search for pairs of bvh_pairs.h and pair_events.h.
#ifndef HALFSPACE_DISPATCH_BVH_PAIRS_H_
#define HALFSPACE_DISPATCH_BVH_PAIRS_H_

#include <cstddef>

#include "halfspace/bvh_pairs.h"
#include "halfspace/detail/bvh.h"
#include "kernels/results.h"

namespace halfspace::detail {

// Checks the arguments, in the name of `call`, and writes the pairs.
// `options.skip` is not read.
void FindPairs(const PairSources& sources, const PairOptions& options,
               const char* call, Results<IdPair>& pairs);

// Whether a search for the pairs of `ids` objects takes less time than a search
// for all pairs of the world.
inline bool IsSmallSet(std::size_t ids, std::size_t objects) {
  return ids < objects / 4;
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_PAIRS_H_
