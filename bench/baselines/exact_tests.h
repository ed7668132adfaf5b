// Exact tests of two shapes, of the kind that follow a rejection: by separating
// axes, in floats, as engines have them.
#ifndef HALFSPACE_BENCH_BASELINES_EXACT_TESTS_H_
#define HALFSPACE_BENCH_BASELINES_EXACT_TESTS_H_

#include <array>

#include "halfspace/shapes.h"

namespace halfspace::bench {

using Vector3 = std::array<float, 3>;
using Triangle = std::array<Vector3, 3>;

struct OrientedBox {
  Vector3 center;
  std::array<Vector3, 3> axes;  // unit vectors
  Vector3 half;                 // along each of them
};

// True if they have a point in common.
bool Touch(const Triangle& a, const Triangle& b);
bool Touch(const Sphere3& a, const Sphere3& b);
bool Touch(const OrientedBox& a, const OrientedBox& b);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_EXACT_TESTS_H_
