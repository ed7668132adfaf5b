// Many queries in a call.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/sections/contest.h"
#include "bench/worlds/workload.h"
#include "halfspace/quantized.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

// A world, and what its calls write.
struct Scene {
  std::string name;
  AaboWorld3 objects;
  ShapeQueries queries;
  QuantizedWorld<AaboView3> quantized{objects};
  std::vector<std::uint64_t> masks =
      std::vector<std::uint64_t>(queries.size() * MaskWords(objects.size()));
  std::vector<std::size_t> counts = std::vector<std::size_t>(queries.size());
  std::vector<std::uint32_t> ids = {};
  std::vector<std::uint32_t> of_queries = {};

  // Of each query, by a flat scan.
  std::vector<std::size_t> CountsOf(ShapeKind shape) const {
    std::vector<std::size_t> found(queries.size());
    queries.With(shape, objects.view(), [&](const auto& view, const auto& all) {
      SurvivorCounts(view, all, found, {.schedule = Schedule::kFlat});
    });
    return found;
  }
};

// Calls for all queries, on one target.
void AddCalls(Contest& contest, Scene& scene, Target target) {
  // count() makes the counts of what call() has written.
  const auto add = [&](std::string name, ShapeKind shape, auto call,
                       auto count) {
    Case c = CaseOfObjects(scene.queries.size() * scene.objects.size(), call);
    c.check = [&scene, shape, call, count]() -> std::string {
      std::fill(scene.counts.begin(), scene.counts.end(), 99u);
      call();
      count();
      return scene.counts == scene.CountsOf(shape)
                 ? ""
                 : "the survivors are not as many as a flat scan finds";
    };
    contest.Add({std::move(name), scene.name, NameOf(target),
                 scene.objects.size(), scene.queries.size()},
                std::move(c));
  };
  for (ShapeKind shape : kShapes) {
    add(
        std::string(NameOf(shape)) + " flat, masks of many", shape,
        [&scene, shape, target] {
          scene.queries.With(
              shape, scene.objects.view(),
              [&](const auto& view, const auto& queries) {
                SurvivorMasks(view, queries, scene.masks,
                              {.schedule = Schedule::kFlat, .target = target});
              });
        },
        [&scene] {
          const std::size_t words = MaskWords(scene.objects.size());
          for (std::size_t q = 0; q < scene.counts.size(); ++q) {
            scene.counts[q] = 0;
            for (std::size_t w = 0; w < words; ++w) {
              scene.counts[q] += static_cast<std::size_t>(
                  std::popcount(scene.masks[q * words + w]));
            }
          }
        });
  }
  add(
      "AABO uint8 refined, counts of many", ShapeKind::kAabo,
      [&scene, target] {
        SurvivorCounts(scene.quantized, scene.queries.aabos(), scene.counts,
                       {.target = target});
      },
      [] {});
  add(
      "simplex, counts of many", ShapeKind::kSimplex,
      [&scene, target] {
        SurvivorCounts(scene.objects.view().simplex(),
                       scene.queries.simplices(), scene.counts,
                       {.target = target});
      },
      [] {});
  const auto add_pairs = [&](const char* name, auto world) {
    add(
        name, ShapeKind::kAabo,
        [&scene, target, world] {
          const std::size_t pairs = SurvivorPairs(
              world(), scene.queries.aabos(), std::span(scene.of_queries),
              scene.ids, {.target = target});
          KeepResult(static_cast<std::uint32_t>(pairs));
        },
        [&scene] {
          std::fill(scene.counts.begin(), scene.counts.end(), 0u);
          for (std::uint32_t query : scene.of_queries) ++scene.counts[query];
        });
  };
  add_pairs(
      "AABO uint8 refined, pairs", [&scene]() -> const auto& {
        return scene.quantized;
      });
  add_pairs("AABO floats, pairs", [&scene] { return scene.objects.view(); });
}

}  // namespace

// 100 queries a call, and 16 in the first-level cache.
Tables RunThroughput(Run& run) {
  Table table{"throughput",
              "many queries in a call: ns per object and query",
              {Key("what"), Key("set"), Key("target"), Key("objects"),
               Key("queries"), Lower("ns/pair", "", 4)}};
  constexpr std::size_t kQueries = 100;
  const std::size_t objects = run.is_quick() ? 1'000'000 : 10'000'000;
  // Floats, quantized bounds with their records, and a bit for each query.
  constexpr std::size_t kBytes = 32 + 8 + 32 + kQueries / 8 + 1;
  const std::size_t available = run.machine.available_memory;
  if (run.machine.is_emulated ||
      (available != 0 && objects * kBytes > available / 4)) {
    table.notes.push_back("Not measured: the scene needs " +
                          Mebibytes(objects * kBytes) +
                          ", more than a quarter of the free memory, or the "
                          "CPU is emulated.");
    return {table};
  }
  const Workload& workload = run.Measured();
  std::vector<Aabo3> few;
  for (std::size_t q = 0; q < 16; ++q) {
    few.push_back(workload.queries[q % workload.queries.size()]);
  }
  Workload made = MakeScene(objects, kQueries, run.options.seed);
  std::vector<Scene> scenes;
  scenes.push_back(
      {"L1",
       ResizedTo(workload.objects, run.Reached({"L1"}).empty()
                                       ? 512
                                       : run.Reached({"L1"})[0].objects),
       ShapeQueries(few)});
  scenes.push_back(
      {"scene", std::move(made.objects), ShapeQueries(made.queries)});
  Effort effort = run.effort;
  effort.repetitions = std::min<std::size_t>(effort.repetitions, 5);
  for (Scene& scene : scenes) {
    const std::vector<std::size_t> counts = scene.CountsOf(ShapeKind::kAabo);
    scene.ids.resize(
        std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    scene.of_queries.resize(scene.ids.size());
    for (Target target : run.WidthTargets()) {
      Contest contest(run, "throughput");
      AddCalls(contest, scene, target);
      contest.Time(effort);
      contest.AddTo(table, [&](std::size_t i) -> Row {
        return {SpreadOf(contest.timing(i))};
      });
    }
  }
  return {table};
}

}  // namespace halfspace::bench
