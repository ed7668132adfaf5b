// A moving body against many stored ones: the broad phase of a physics step.
//
// Over one time step the body sweeps from its start to its end; its bound is
// swept along. The world is one of simplices, the smallest record: 16 bytes an
// object. It lives for one step, in an arena.
#include <halfspace/halfspace.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

// Memory of one step: block after block, and given back all at once.
struct StepArena {
  void* allocate(std::size_t bytes, std::size_t alignment) {
    void* block = memory.data() + used;
    std::size_t left = memory.size() - used;
    if (std::align(alignment, bytes, block, left) == nullptr) return nullptr;
    used = memory.size() - left + bytes;
    return block;
  }
  void deallocate(void*, std::size_t, std::size_t) {}

  std::vector<std::byte> memory;
  std::size_t used = 0;
};

int main() {
  // Crates, each turned by a quarter of a right angle.
  constexpr float kCos = 0.92387953f;
  constexpr float kSin = 0.38268343f;
  StepArena arena{std::vector<std::byte>(65536)};
  halfspace::SimplexWorld3 world(halfspace::MemoryFrom(arena));
  world.Reserve(1600);  // an arena does not use a block again
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
