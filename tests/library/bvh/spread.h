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
#include "tests/library/support/cases.h"
#include "tests/library/support/inputs.h"

namespace halfspace::testing {

using Ids = std::vector<std::uint32_t>;

inline Ids InOrder(std::span<const std::uint32_t> ids) {
  Ids sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

// An octahedron as an object of the view, and as a query.
template <typename View>
typename View::Bound ObjectOf(const Aabo<View::Bound::kDimensions>& bound) {
  if constexpr (!HasMaxima<View>) {
    return bound.up();
  } else if constexpr (View::Bound::kAxes == View::Bound::kDimensions) {
    return bound.aabb();
  } else {
    return bound;
  }
}
template <typename View>
typename View::Query QueryOf(const Aabo<View::Bound::kDimensions>& bound) {
  if constexpr (!HasMaxima<View>) {
    return bound.down();
  } else {
    return ObjectOf<View>(bound);
  }
}

// Spheres in a cube of side 100, seen as bounds of the view.
template <typename View>
class Spread {
 public:
  using Bound = typename View::Bound;
  using Query = typename View::Query;

  explicit Spread(float radius, std::uint64_t seed = 1)
      : random_(seed), radius_(radius) {}

  Bound NextObject() { return ObjectOf<View>(Next()); }
  Query NextQuery() { return QueryOf<View>(Next()); }
  World<View> Objects(std::size_t count) {
    World<View> world;
    for (std::size_t i = 0; i < count; ++i) world.Push(NextObject());
    return world;
  }

 private:
  Aabo<Bound::kDimensions> Next() {
    std::uniform_real_distribution<float> coordinate(-50.0f, 50.0f);
    Sphere<Bound::kDimensions> sphere;
    for (float& x : sphere.center) x = coordinate(random_);
    sphere.radius = radius_;
    return BoundSphere(sphere);
  }

  Random random_;
  float radius_;
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SPREAD_H_
