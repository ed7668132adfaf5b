// Random points of the scenes' clouds.
#ifndef HALFSPACE_BENCH_WORLDS_UNIT_SPHERE_H_
#define HALFSPACE_BENCH_WORLDS_UNIT_SPHERE_H_

#include <array>
#include <cstddef>

#include "bench/worlds/random.h"

namespace halfspace::bench {

// Uniform in the ball of radius 1.
template <std::size_t kDims = 3>
std::array<float, kDims> PointInUnitSphere(Random& random) {
  for (;;) {
    std::array<float, kDims> p;
    double square = 0.0;
    for (float& coordinate : p) {
      coordinate = random.Signed();
      square += double{coordinate} * double{coordinate};
    }
    if (square <= 1.0) return p;
  }
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_UNIT_SPHERE_H_
