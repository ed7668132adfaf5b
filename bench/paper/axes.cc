#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/point_source.h"
#include "halfspace/fit.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kCounted = 32768;
constexpr std::size_t kCountedQueries = 8192;

Aabo3 BoundOnStandardAxes(std::span<const float> points) {
  return BoundPoints(Points3{points.data(), points.size() / 3});
}

struct BothBounds {
  Aabo3 standard;
  Aabo3 regular;
};

BothBounds BoundBoth(std::span<const float> points) {
  return {BoundOnStandardAxes(points), BoundOnRegularAxes(points)};
}

// Survivors with the simplex of each kind of axes, and how they share their
// sign: an even object whose two simplices differ in looseness.
void CountWorld(Run& run, const PointSource& source, Table& table) {
  AaboWorld3 standard;
  AaboWorld3 regular;
  for (std::size_t i = 0; i < source.objects; ++i) {
    const BothBounds both = BoundBoth(source.next_object());
    standard.Push(both.standard);
    regular.Push(both.regular);
  }
  const std::size_t queries = std::min(kCountedQueries, 4 * source.objects);
  std::array<std::size_t, 2> simplex{};
  std::array<std::size_t, 2> aabo{};
  std::size_t boxes = 0;
  for (std::size_t q = 0; q < queries; ++q) {
    const BothBounds query = BoundBoth(source.next_query());
    boxes += CountSurvivors(standard.view().aabb(), query.standard.aabb());
    const auto count = [&](const AaboView3& view, const Aabo3& with,
                           std::size_t kind) {
      simplex[kind] += CountSurvivors(view.simplex(), with.down());
      aabo[kind] += CountSurvivors(view, with);
    };
    count(standard.view(), query.standard, 0);
    count(regular.view(), query.regular, 1);
    if (q % 256 == 0) {
      run.progress.Update(static_cast<double>(q) /
                          static_cast<double>(queries));
    }
  }
  for (std::size_t kind : {0, 1}) {
    const auto over = [boxes](std::size_t survivors) {
      return static_cast<double>(survivors) / static_cast<double>(boxes);
    };
    table.Add({source.name, kind == 0 ? "standard" : "regular", simplex[kind],
               over(simplex[kind]), aabo[kind], over(aabo[kind])});
  }
}

}  // namespace

Tables RunAxes(Run& run) {
  const std::uint64_t seed = run.options.seed;
  std::vector<PointSource> worlds = {BallSource(kCounted, seed),
                                     BoxSource(kCounted, seed),
                                     MixedSource(kCounted, seed)};
  if (run.input() != nullptr) {
    worlds.push_back(FileSource(*run.input(), kCounted, seed));
  }
  Table kept{"axes",
             "survivors with the axes X, Y, Z, -(X + Y + Z) and with those of "
             "a regular simplex",
             {Key("world"), Key("axes"), Value("simplex", "", 0),
              Value("over AABB"), Value("AABO", "", 0), Value("over AABB")}};
  for (PointSource& world : worlds) CountWorld(run, world, kept);
  return {kept};
}

}  // namespace halfspace::bench
