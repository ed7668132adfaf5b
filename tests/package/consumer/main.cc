// A user of the library: bounds two triangles, asks which of them a third one
// could touch, on every target of this machine, and checks the answer, as
// floats and as quantized bounds. In C++17, with one caller in C++20.
#include <halfspace/halfspace.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "cxx20.h"

static_assert(__cplusplus < 202002L, "what links the library stays C++17");

namespace {

void Check(bool is_right, const char* what) {
  if (is_right) return;
  std::fprintf(stderr, "wrong: %s\n", what);
  std::exit(1);
}

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
    halfspace::Options options;
    options.target = target;
    halfspace::SurvivorMask(world, query, mask, options);
    const std::size_t boxes =
        halfspace::CountSurvivors(world.view().aabb(), query.aabb(), options);
    Check(mask[0] == 0b01 && boxes == 2, target.name().data());
  }

  // Enough objects to train on: quantized bounds answer wrongly if this file
  // and the library were compiled for different layouts of them.
  halfspace::QuantizedWorld<halfspace::AaboView3> quantized_world;
  for (std::size_t i = 0; i < 200; ++i) quantized_world.Push(world.Get(i % 2));
  const auto copy = quantized_world;
  const halfspace::QuantizedBounds<halfspace::AaboView3> quantized(world);
  Check(halfspace::CountSurvivors(quantized_world, query) == 100 &&
            halfspace::CountSurvivors(copy.quantized(), query) == 100 &&
            copy.Fits(),
        "a quantized world");
  Check(halfspace::CountSurvivors(quantized, query) == 1 &&
            halfspace::CountSurvivors(halfspace::Refined(quantized, world),
                                      query) == 1 &&
            quantized.Fits(),
        "quantized bounds");

  // Lists as callers have them: the same calls from C++17 and from C++20.
  const std::vector<halfspace::Aabo3> bounds = {world.Get(1), world.Get(0)};
  const halfspace::AaboWorld3 turned(bounds);
  std::vector<std::uint32_t> indices(turned.size());
  std::uint32_t indices_of_cxx20[2];
  Check(halfspace::Survivors(turned, query, indices) == 1 && indices[0] == 1,
        "a list of C++17");
  Check(SurvivorsInCxx20(turned, query, indices_of_cxx20) == 1 &&
            indices_of_cxx20[0] == 1,
        "a list of C++20");
  const halfspace::Segment3 segment = {{0, 0, 0}, {4, 4, 4}};
  std::vector<halfspace::Aabo3> pieces(4);
  halfspace::BoundSegmentPieces(segment, pieces);
  Check(pieces[3] == halfspace::BoundSegment(
                         halfspace::Segment3{{3, 3, 3}, {4, 4, 4}}) &&
            pieces[3] != pieces[2],
        "a piece");
  const halfspace::TargetChoice choice = halfspace::DescribeTargetChoice();
  Check(choice.target == halfspace::ChosenTarget() && choice.error.empty(),
        "the choice of a target");
  std::printf("halfspace %s\n", HALFSPACE_VERSION_STRING);
  return 0;
}
