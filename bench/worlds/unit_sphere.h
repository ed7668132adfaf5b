// Random points of the scenes' clouds.
#ifndef HALFSPACE_BENCH_WORLDS_UNIT_SPHERE_H_
#define HALFSPACE_BENCH_WORLDS_UNIT_SPHERE_H_

#include <array>

#include "bench/worlds/random.h"

namespace halfspace::bench {

inline std::array<float, 3> PointInUnitSphere(Random& random) {
  for (;;) {
    const std::array<float, 3> p = {random.Signed(), random.Signed(),
                                    random.Signed()};
    const double x = p[0];
    const double y = p[1];
    const double z = p[2];
    if (x * x + y * y + z * z <= 1.0) return p;
  }
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_UNIT_SPHERE_H_
