#include <algorithm>

#include "bench/baselines/baselines.h"

namespace halfspace::bench {
namespace {

// 16 KiB of up simplices.
constexpr std::size_t kTile = 1024;

std::size_t CountTile(const HalvesWorld& world, const Aabo3& query,
                      std::size_t begin, std::size_t end) {
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const HalvesWorld::Half& up = world.up[i];
    if (up.x > query.max[0]) continue;
    if (up.y > query.max[1]) continue;
    if (up.z > query.max[2]) continue;
    if (up.d > query.max[3]) continue;
    const HalvesWorld::Half& down = world.down[i];
    if (down.x < query.min[0]) continue;
    if (down.y < query.min[1]) continue;
    if (down.z < query.min[2]) continue;
    if (down.d < query.min[3]) continue;
    ++count;
  }
  return count;
}

}  // namespace

HalvesWorld MakeHalves(const AaboView3& view) {
  HalvesWorld world;
  world.up.resize(view.size);
  world.down.resize(view.size);
  for (std::size_t i = 0; i < view.size; ++i) {
    world.up[i] = {view.min[0][i], view.min[1][i], view.min[2][i],
                   view.min[3][i]};
    world.down[i] = {view.max[0][i], view.max[1][i], view.max[2][i],
                     view.max[3][i]};
  }
  return world;
}

void CountScalar(const HalvesWorld& world, std::span<const Aabo3> queries,
                 std::span<std::size_t> counts) {
  std::fill(counts.begin(), counts.end(), std::size_t{0});
  for (std::size_t begin = 0; begin < world.up.size(); begin += kTile) {
    const std::size_t end = std::min(begin + kTile, world.up.size());
    for (std::size_t q = 0; q < queries.size(); ++q) {
      counts[q] += CountTile(world, queries[q], begin, end);
    }
  }
}

}  // namespace halfspace::bench
