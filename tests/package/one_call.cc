// The least program with a scan in it: one call on one world.
#include <array>
#include <cstdint>

#include "halfspace/reject.h"
#include "halfspace/world.h"

int main() {
  halfspace::AabbWorld3 world;
  world.Push({{0, 0, 0}, {1, 1, 1}});
  std::array<std::uint32_t, 1> survivors;
  const halfspace::Aabb3 query = {{1, 1, 1}, {2, 2, 2}};
  return halfspace::Survivors(world, query, survivors) == 1 ? 0 : 1;
}
