// A user of the library: bounds two triangles, asks which of them a third one
// could touch, on every target of this machine, and checks the answer.
#include <halfspace/halfspace.h>

#include <array>
#include <cstdint>
#include <cstdio>

namespace {

using Triangle = std::array<float, 9>;

halfspace::Aabo3 Bound(const Triangle& triangle) {
  return halfspace::BoundPoints(halfspace::Points3{triangle.data(), 3});
}

}  // namespace

int main() {
  // The query ends at x + y + z = 2 and the second triangle begins at 3; their
  // boxes overlap, so only the D axis tells them apart.
  halfspace::AaboWorld3 world;
  world.Push(Bound({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  world.Push(Bound({2, 0, 1, 0, 2, 1, 1, 1, 2}));
  const halfspace::Aabo3 query = Bound({0, 0, 0, 2, 0, 0, 0, 0, 2});

  for (halfspace::Target target : halfspace::SupportedTargets()) {
    std::array<std::uint64_t, 1> mask{};
    halfspace::Target ran;
    halfspace::SurvivorMask(world, query, mask,
                            {.target = target, .ran = &ran});
    const std::size_t boxes = halfspace::CountSurvivors(
        world.view().aabb(), query.aabb(), {.target = target});
    if (ran != target || mask[0] != 0b01 || boxes != 2) {
      std::fprintf(stderr, "%s: survivors %llx of 1, boxes %zu of 2\n",
                   std::string(target.name()).c_str(),
                   static_cast<unsigned long long>(mask[0]), boxes);
      return 1;
    }
  }
  std::printf("halfspace %s\n", HALFSPACE_VERSION_STRING);
  return 0;
}
