// The program of the README.
#include <halfspace/halfspace.h>

#include <cstdio>

int main() {
  halfspace::AaboWorld3 world;
  const float triangle[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};  // x y z of 3 corners
  world.Push(halfspace::BoundPoints(halfspace::Points3{triangle, 3}));
  world.Push(halfspace::BoundAabb(halfspace::Aabb3{{2, 2, 2}, {3, 3, 3}}));
  const float segment[] = {0.5f, 0.5f, -1, 0.5f, 0.5f, 1};
  const auto query = halfspace::BoundPoints(halfspace::Points3{segment, 2});
  std::uint32_t touched[2];  // one for each object
  const auto found = halfspace::Survivors(world, query, touched);
  for (std::size_t i = 0; i < found; ++i)
    std::printf("object %u may be touched\n", touched[i]);
}
