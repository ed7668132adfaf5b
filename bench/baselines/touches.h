// The tests that a competitor leaves to its user. Without branches, as what a
// tree comes upon is hard to predict.
#ifndef HALFSPACE_BENCH_BASELINES_TOUCHES_H_
#define HALFSPACE_BENCH_BASELINES_TOUCHES_H_

#include <cstddef>

#include "halfspace/bounds.h"

namespace halfspace::bench {

template <int kDims>
bool Touches(const Aabb<kDims>& a, const Aabb<kDims>& b) {
  bool touches = true;
  for (std::size_t k = 0; k < a.min.size(); ++k) {
    touches &= a.min[k] <= b.max[k];
    touches &= b.min[k] <= a.max[k];
  }
  return touches;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_TOUCHES_H_
