// The tests that a competitor leaves to its user. Without branches, as what a
// tree comes upon is hard to predict.
#ifndef HALFSPACE_BENCH_BASELINES_TOUCHES_H_
#define HALFSPACE_BENCH_BASELINES_TOUCHES_H_

#include <algorithm>
#include <cstddef>

#include "halfspace/bounds.h"
#include "halfspace/shapes.h"

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

// No plane lies between the two: neither one of the box, nor one through the
// segment and along an axis. Slabs without the division. In double, a
// difference of floats is exact unless one is 2^29 times the other; a product
// is exact if its two differences have no more than 53 bits together.
inline bool Touches(const Segment<3>& segment, const Aabb3& box) {
  double direction[3];
  double low[3];  // the box, seen from the segment's first end
  double high[3];
  bool touches = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = segment.a[k];
    direction[k] = segment.b[k] - a;
    low[k] = box.min[k] - a;
    high[k] = box.max[k] - a;
    touches &= low[k] <= std::max(0.0, direction[k]);
    touches &= high[k] >= std::min(0.0, direction[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t j = (k + 1) % 3;
    const double k_low = direction[j] * low[k];
    const double k_high = direction[j] * high[k];
    const double j_low = direction[k] * low[j];
    const double j_high = direction[k] * high[j];
    touches &= std::min(k_low, k_high) <= std::max(j_low, j_high);
    touches &= std::min(j_low, j_high) <= std::max(k_low, k_high);
  }
  return touches;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_TOUCHES_H_
