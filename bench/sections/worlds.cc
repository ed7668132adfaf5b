// Worlds whose axes differ: points of several units, layers, clusters and long
// worlds, and queries of several forms. How many leaves does a query read?
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/report/table.h"
#include "bench/sections/contest.h"
#include "bench/worlds/random.h"
#include "bench/worlds/workload.h"
#include "halfspace/bvh.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

using Extents = std::array<float, 3>;

constexpr float kAny = std::numeric_limits<float>::infinity();
constexpr Extents kPoint = {};

// Objects are uniform in a box of these extents, or in two that are `apart` on
// each axis. A query is around the center of an object.
struct UnevenWorld {
  const char* name;
  Extents world;
  float apart;
  Extents object;
  const char* queries;
  Extents query;
};
// A query finds about ten of 100 000 objects.
constexpr UnevenWorld kWorlds[] = {
    {"points in a cube", {1, 1, 1}, 0, kPoint, "cubes", {.046f, .046f, .046f}},
    {"points in a cube", {1, 1, 1}, 0, kPoint, "any z", {.01f, .01f, kAny}},
    {"boxes in a cube",
     {1, 1, 1},
     0,
     {.01f, .01f, .01f},
     "cubes",
     {.04f, .04f, .04f}},
    {"points in 1 x 1 x 10 000",
     {1, 1, 1e4f},
     0,
     kPoint,
     "any z",
     {.01f, .01f, kAny}},
    {"points in 1 x 1 x 10 000",
     {1, 1, 1e4f},
     0,
     kPoint,
     "of its form",
     {.046f, .046f, 460}},
    {"points in 1 x 1 x 10 000", {1, 1, 1e4f}, 0, kPoint, "cubes", {1, 1, 1}},
    {"boxes in 1 x 1 x 10 000",
     {1, 1, 1e4f},
     0,
     {.005f, .005f, 50},
     "any z",
     {.008f, .008f, kAny}},
    {"degrees and seconds",
     {360, 180, 1e6f},
     0,
     kPoint,
     "of its form",
     {16, 8, 5e4f}},
    {"degrees and seconds",
     {360, 180, 1e6f},
     0,
     kPoint,
     "any time",
     {3.6f, 1.8f, kAny}},
    {"boxes in degrees and meters",
     {10, 10, 2e3f},
     0,
     {1e-3f, 1e-3f, 10},
     "of its form",
     {.46f, .46f, 92}},
    {"boxes in degrees and meters",
     {10, 10, 2e3f},
     0,
     {1e-3f, 1e-3f, 10},
     "any height",
     {.1f, .1f, kAny}},
    {"boxes in 4000 x 4000 x 100",
     {4e3f, 4e3f, 100},
     0,
     {2, 2, 2},
     "cubes",
     {54, 54, 54}},
    {"boxes in 100 000 x 100 x 30",
     {1e5f, 100, 30},
     0,
     {1, 1, 1},
     "cubes",
     {30, 30, 30}},
    {"points in 100 000 x 100 x 30",
     {1e5f, 100, 30},
     0,
     kPoint,
     "cubes",
     {30, 30, 30}},
    {"two cubes of 1, 1000 apart",
     {1, 1, 1},
     1e3f,
     kPoint,
     "cubes",
     {.058f, .058f, .058f}},
    {"two rooms, 100 km apart",
     {10, 10, 3},
     1e5f,
     {.1f, .1f, .1f},
     "cubes",
     {.3f, .3f, .3f}},
};

std::vector<Aabb3> MakeBoxes(const UnevenWorld& world, std::size_t count,
                             std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb3> boxes(count);
  for (Aabb3& box : boxes) {
    const float begin = random.Below(2) == 0 ? 0 : world.apart;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto share = [&] { return 0.5f * random.Signed() + 0.5f; };
      box.min[k] = begin + world.world[k] * share();
      box.max[k] = box.min[k] + world.object[k] * share();
    }
  }
  return boxes;
}

std::vector<Aabb3> MakeQueries(const UnevenWorld& world,
                               const std::vector<Aabb3>& boxes) {
  std::vector<Aabb3> queries(kTimedQueries);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Aabb3& box = boxes[q * 7919 % boxes.size()];
    for (std::size_t k = 0; k < 3; ++k) {
      const float center = box.min[k] + (box.max[k] - box.min[k]) / 2;
      queries[q].min[k] = center - world.query[k] / 2;
      queries[q].max[k] = center + world.query[k] / 2;
    }
  }
  return queries;
}

void RunWorld(Run& run, const UnevenWorld& world, std::size_t objects,
              Table& table) {
  const std::vector<Aabb3> boxes = MakeBoxes(world, objects, run.options.seed);
  const std::vector<Aabb3> queries = MakeQueries(world, boxes);
  const AabbWorld3 flat(boxes);
  struct Built {
    const char* name;
    AabbBvh3 bvh;
    double leaves;
  };
  std::vector<Built> all;
  const auto add = [&](const char* name, BuildQuality quality, bool is_told) {
    BuildOptions options{.quality = quality, .target = run.best()};
    if (is_told) options.query_extents = world.query;
    all.push_back({name, AabbBvh3(boxes, options), 0});
    QueryStatistics statistics;
    for (const Aabb3& query : queries) {
      std::ignore =
          CountSurvivors(all.back().bvh, query,
                         {.target = run.best(), .statistics = &statistics});
    }
    all.back().leaves = static_cast<double>(statistics.leaves) /
                        static_cast<double>(queries.size());
  };
  add("kHigh", BuildQuality::kHigh, false);
  add("kFast", BuildQuality::kFast, false);
  add("kHigh, query_extents", BuildQuality::kHigh, true);
  add("kFast, query_extents", BuildQuality::kFast, true);
  double least = kAny;
  for (const Built& built : all) least = std::min(least, built.leaves);

  constexpr std::size_t kChecked = 100;
  std::vector<std::size_t> expected;
  for (std::size_t q = 0; q < kChecked; ++q) {
    expected.push_back(CountSurvivors(flat, queries[q]));
  }
  Contest contest(run,
                  std::string("worlds/") + world.name + ", " + world.queries);
  const auto compete = [&](const char* name, const auto& searched) {
    Case c = InTurn(kTimedQueries, 1000, [&](std::size_t q) {
      std::ignore = CountSurvivors(searched, queries[q]);
    });
    c.check =
        CheckOf(kChecked, "the query has another number of objects",
                [&](std::size_t q) {
                  return CountSurvivors(searched, queries[q]) == expected[q];
                });
    contest.Add({world.name, world.queries, name}, std::move(c));
  };
  for (const Built& built : all) compete(built.name, built.bvh);
  contest.Time();
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {all[i].leaves, all[i].leaves / least, contest.Median(i) / 1e3};
  });
}

}  // namespace

Tables RunWorlds(Run& run) {
  const std::size_t objects = run.MostObjects(100'000, 20'000);
  Table table{
      "worlds",
      "leaves that a query of a BVH reads where axes differ, of " +
          std::to_string((objects + 63) / 64),
      {Key("world"), Key("queries"), Key("build"), Value("leaves", "", 1),
       Value("over the least", "", 2), Value("query", "us", 3)}};
  for (const UnevenWorld& world : kWorlds) {
    RunWorld(run, world, objects, table);
  }
  table.notes = {
      "Of boxes in 3 dimensions. A query finds about ten of 100 000. `over the "
      "least` divides the leaves by those of the best of the four builds."};
  return {table};
}

}  // namespace halfspace::bench
