// A moving body against many stored ones: the broad phase of a physics step.
//
// Over one time step the body sweeps from its start to its end; its bound is
// swept along. The world is one of simplices, the smallest record: 16 bytes an
// object.
#include <halfspace/halfspace.h>

#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  // Crates, each turned by a quarter of a right angle.
  constexpr float kCos = 0.92387953f;
  constexpr float kSin = 0.38268343f;
  halfspace::SimplexWorld3 world;
  for (int x = 0; x < 40; ++x) {
    for (int z = 0; z < 40; ++z) {
      const halfspace::OrientedBox3 crate = {
          {2.0f * static_cast<float>(x), 0, 2.0f * static_cast<float>(z)},
          {{{kCos, 0, kSin}, {0, 1, 0}, {-kSin, 0, kCos}}},
          {0.5f, 0.5f, 0.5f}};
      world.Push(halfspace::BoundOrientedBox(crate).up());
    }
  }

  // One is taken away. The others keep their indices: an empty bound is a hole,
  // which no query finds, until Set puts another crate there.
  world.Set(415, halfspace::UpSimplex3::Empty());

  // A sphere flies along X, over the crates and down into their rows.
  const halfspace::Aabo3 sphere =
      halfspace::BoundSphere(halfspace::Sphere3{{10, 1.5f, 20}, 0.5f});
  const halfspace::DownSimplex3 query =
      halfspace::Sweep(sphere, {4, -1, 0}).down();

  std::vector<std::uint32_t> candidates(world.size());
  const std::size_t found = halfspace::Survivors(world, query, candidates);
  std::printf("%zu of %zu bodies go on to the narrow phase\n", found,
              world.size());
  return found == 0 ? 1 : 0;
}
