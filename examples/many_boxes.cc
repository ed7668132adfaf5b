// Which towers could a flight touch? One query after another over a hundred
// thousand boxes that rest, by a BVH, which is made once.
#include <halfspace/halfspace.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  // Houses on a plain, of which every seventh is a tower.
  std::vector<halfspace::Aabb3> houses;
  for (int i = 0; i < 100'000; ++i) {
    const auto x = static_cast<float>(i % 400) * 12.0f;
    const auto y = static_cast<float>(i / 400) * 12.0f;
    const float height = i % 7 == 0 ? 60.0f : 9.0f;
    houses.push_back({{x, y, 0.0f}, {x + 10.0f, y + 10.0f, height}});
  }
  const halfspace::AabbBvh3 world(houses);

  // The towers that a flight at a height of 30 could touch.
  std::vector<std::uint32_t> ids(world.size());
  std::size_t towers = 0;
  std::uint32_t last = 0;
  for (int second = 0; second < 100; ++second) {
    const auto at = static_cast<float>(second) * 25.0f;
    const halfspace::Aabb3 flight = {{at, at, 30.0f},
                                     {at + 25.0f, at + 25.0f, 32.0f}};
    const std::size_t found = Survivors(world, flight, ids);
    for (std::size_t i = 0; i < found; ++i) last = std::max(last, ids[i]);
    towers += found;
  }

  // A whole district is counted by its nodes.
  const halfspace::Aabb3 district = {{0.0f, 0.0f, 0.0f},
                                     {2400.0f, 1200.0f, 100.0f}};
  const std::size_t count = CountSurvivors(world, district);
  std::printf(
      "%zu towers along the flight, the last is house %u; %zu houses in the "
      "district\n",
      towers, last, count);
  return last % 7 == 0 && count == 201 * 101 ? 0 : 1;
}
