// A moving body against many stored ones: the broad phase of a physics step.
//
// Over one time step the body sweeps the hull of its start and its end, so the
// bound of both point sets together encloses the whole motion. The world is one
// of simplices, the smallest record: 16 bytes an object.
#include <halfspace/halfspace.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

using Corners = std::array<float, 24>;  // x y z of a cube's eight corners

Corners CubeAt(float x, float y, float z) {
  Corners corners{};
  for (std::size_t i = 0; i < 8; ++i) {
    corners[3 * i + 0] = x + ((i & 1) != 0 ? 0.5f : -0.5f);
    corners[3 * i + 1] = y + ((i & 2) != 0 ? 0.5f : -0.5f);
    corners[3 * i + 2] = z + ((i & 4) != 0 ? 0.5f : -0.5f);
  }
  return corners;
}

}  // namespace

int main() {
  halfspace::SimplexWorld3 world;
  for (int x = 0; x < 40; ++x) {
    for (int z = 0; z < 40; ++z) {
      const Corners cube =
          CubeAt(2.0f * static_cast<float>(x), 0, 2.0f * static_cast<float>(z));
      world.Push(
          halfspace::BoundPoints(halfspace::Points3{cube.data(), 8}).up());
    }
  }

  // The body flies along X, over the cubes and down into their rows.
  const Corners start = CubeAt(10, 1.5f, 20);
  const Corners end = CubeAt(14, 0.5f, 20);
  std::vector<float> swept(start.begin(), start.end());
  swept.insert(swept.end(), end.begin(), end.end());
  const halfspace::DownSimplex3 query =
      halfspace::BoundPoints(halfspace::Points3{swept.data(), 16}).down();

  std::vector<std::uint32_t> candidates(world.size());
  const halfspace::SurvivorCount found =
      halfspace::Survivors(world, query, candidates);
  std::printf("%zu of %zu bodies go on to the narrow phase (%.*s)\n",
              found.count, world.size(),
              static_cast<int>(found.target.name().size()),
              found.target.name().data());
  return found.count == 0 ? 1 : 0;
}
