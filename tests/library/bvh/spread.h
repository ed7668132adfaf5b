// Worlds and queries for the tests of BVHs.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_SPREAD_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_SPREAD_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

using Ids = std::vector<std::uint32_t>;

inline Ids InOrder(std::span<const std::uint32_t> ids) {
  Ids sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// Boxes or octahedra of spheres in a cube of side 100.
template <typename Bound = Aabb3>
class Spread {
 public:
  explicit Spread(float radius, std::uint64_t seed = 1)
      : random_(seed), radius_(radius) {}

  Bound Next() {
    std::uniform_real_distribution<float> coordinate(-50.0f, 50.0f);
    Sphere<Bound::kDimensions> sphere;
    for (float& x : sphere.center) x = coordinate(random_);
    sphere.radius = radius_;
    const Aabo<Bound::kDimensions> bound = BoundSphere(sphere);
    if constexpr (Bound::kAxes == Bound::kDimensions) {
      return bound.aabb();
    } else {
      return bound;
    }
  }
  std::vector<Bound> Some(std::size_t count) {
    std::vector<Bound> some(count);
    for (Bound& bound : some) bound = Next();
    return some;
  }

 private:
  Random random_;
  float radius_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SPREAD_H_
