// A selection box over the records of a spatial table, in two dimensions: how
// many rows could match, and is there one at all?
//
// The world is one of octagons (AABOs); the same planes answer as plain boxes
// too, with no copy.
#include <halfspace/halfspace.h>

#include <array>
#include <cstddef>
#include <cstdio>

int main() {
  // Streets: thin diagonal segments, which an axis-aligned box bounds badly.
  halfspace::AaboWorld2 streets;
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<float>(i % 40) * 5.0f;
    const auto y = static_cast<float>(i / 40) * 5.0f;
    const std::array<float, 4> ends = {x, y, x + 20.0f, y - 20.0f};
    streets.Push(halfspace::BoundPoints(halfspace::Points2{ends.data(), 2}));
  }

  const halfspace::Aabo2 selection =
      halfspace::BoundAabb(halfspace::Aabb2{{100, 50}, {104, 54}});

  if (!halfspace::AnySurvivor(streets, selection)) return 1;
  const std::size_t octagons = halfspace::CountSurvivors(streets, selection);
  const std::size_t boxes =
      halfspace::CountSurvivors(streets.view().aabb(), selection.aabb());
  std::printf("%zu rows could match; boxes alone would have kept %zu\n",
              octagons, boxes);
  return octagons <= boxes ? 0 : 1;
}
