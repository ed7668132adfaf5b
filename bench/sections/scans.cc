// Scans: of one query, against reading the planes and against loops by hand; of
// many queries; and how many objects survive.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/baselines/by_hand.h"
#include "bench/inner/target_loops.h"
#include "bench/measure/machine.h"
#include "bench/sections/contest.h"
#include "bench/worlds/working_set.h"
#include "bench/worlds/workload.h"
#include "halfspace/kernels.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

// The case of a loop over the planes of a set, timed per call: of each query,
// its values one after the other, and a mask that survives.
Case LoopCase(WorkingSet& set, ShapeKind shape, LoopByHand loop) {
  const std::size_t count = PlaneCountOf(shape);
  std::vector<float> values;
  for (const Aabo3& query : set.queries()) {
    const std::vector<float> of_query = QueryOf(shape, query);
    values.insert(values.end(), of_query.begin(), of_query.end());
  }
  return set.CallCase(
      shape, [loop, count, values = std::move(values), size = set.objects(),
              planes = PlanesOf(shape, set.view())](std::size_t q,
                                                    std::uint64_t* mask) {
        loop(planes.data(), size, &values[q * count], mask);
      });
}

void AddRows(Run& run, WorkingSet& set, ShapeKind shape, Table& table) {
  Contest contest(run, "kernels");
  // By words as a kernel, by pages, and by planes, with vectors of the two
  // greatest widths: which is fastest depends on the cache and its prefetchers.
  const std::span<const Target> targets = SupportedTargets();
  for (Target target :
       targets.first(std::min<std::size_t>(2, targets.size()))) {
    for (std::size_t turn :
         {kReadBytes, std::size_t{4096}, set.objects() * sizeof(float)}) {
      contest.Add({"read", NameOf(shape), set.name(), NameOf(target), turn},
                  set.ReadCase(shape, turn, target), Who::kLimit);
    }
  }
  for (Target target : run.targets) {
    for (const auto& [name, schedule] : SchedulesOf(shape)) {
      contest.Add(
          {NameOf(shape), set.name(), NameOf(target), name, set.objects()},
          set.LibraryCase(shape, {.schedule = schedule, .target = target}));
    }
    const auto add_by_hand = [&](const char* name, LoopByHand loop) {
      if (loop == nullptr) return;
      Case c = LoopCase(set, shape, loop);
      c.items *= static_cast<double>(set.objects());
      contest.Add(
          {NameOf(shape), set.name(), NameOf(target), name, set.objects()},
          std::move(c));
    };
    add_by_hand("flat, by hand", LoopByHandOf(shape, target.name()));
    if (shape == ShapeKind::kAabb) {
      add_by_hand("by-axis, by hand", StagedByHandOf(target.name()));
    }
  }
  contest.Time();
  const double bytes = static_cast<double>(PlaneCountOf(shape) * sizeof(float));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {SpreadOf(contest.timing(i)), bytes / contest.Median(i),
            RatioOf(contest.fastest(), contest.timing(i)).Times(100.0)};
  });
}

void AddTierRows(Run& run, WorkingSet& set, ShapeKind shape, Target target,
                 Table& table) {
  const LoopByHand by_hand = LoopByHandOf(shape, target.name());
  if (by_hand == nullptr) return;
  const ShapeQueries queries(set.queries());
  const auto checked =
      queries.With(shape, set.view(), [&](const auto& view, const auto& all) {
        return set.CallCase(
            shape, [view, all, target](std::size_t q, std::uint64_t* mask) {
              SurvivorMask(view, all[q], {mask, MaskWords(view.size)},
                           {.target = target});
            });
      });
  Contest contest(run, "tier");
  const auto add = [&](const char* by, Case c, Who who = Who::kOurs) {
    contest.Add({NameOf(shape), NameOf(target), set.objects(), by},
                std::move(c), who);
  };
  add("by hand", LoopCase(set, shape, by_hand), Who::kCompetitor);
  const Kernels<float>& kernels = KernelsOf<float>(target);
  const PerShape<LoopByHand> loops{kernels.boxes3.one, kernels.simplices3.one,
                                   kernels.octahedra3.one};
  add("kernels.h", LoopCase(set, shape, loops.Of(shape)));
  add("reject.h", checked);
  contest.Time();
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {SpreadOf(contest.timing(i)),
            RatioOf(contest.timing(i), contest.fastest())};
  });
}

// ---- Many queries in a call.

// A world, and what its calls write.
struct Scene {
  AaboWorld3 objects;
  ShapeQueries queries;
  QuantizedWorld<AaboView3> quantized{objects};
  SimplexView3 simplices = objects.view().simplex();
  std::vector<std::uint64_t> masks =
      std::vector<std::uint64_t>(queries.size() * MaskWords(objects.size()));
  std::vector<std::size_t> counts = std::vector<std::size_t>(queries.size());
  std::vector<std::uint32_t> ids = {};
  std::vector<std::uint32_t> of_queries = {};

  // The masks of boxes, tile by tile: a tile stays in L1 while all queries are
  // tested on it.
  void MasksByHand(LoopByHand loop) {
    constexpr std::size_t kTile = 1152;
    std::vector<std::vector<float>> values;
    for (const Aabo3& query : queries.aabos()) {
      values.push_back(QueryOf(ShapeKind::kAabb, query));
    }
    const auto planes = PlanesOf(ShapeKind::kAabb, objects.view());
    for (std::size_t i = 0; i < objects.size(); i += kTile) {
      std::vector<const float*> tile = planes;
      for (const float*& plane : tile) plane += i;
      for (std::size_t q = 0; q < queries.size(); ++q) {
        loop(tile.data(), std::min(kTile, objects.size() - i), values[q].data(),
             &masks[q * MaskWords(objects.size()) + i / 64]);
      }
    }
  }

  // The survivors of each query, by a flat scan.
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
  const auto add = [&](const std::string& name, ShapeKind shape, auto call,
                       auto count) {
    Case c = CaseOfObjects(scene.queries.size() * scene.objects.size(), call);
    c.check = CheckOf(1, "the survivors are not as many as a flat scan finds",
                      [&scene, shape, call, count](auto) {
                        std::fill(scene.counts.begin(), scene.counts.end(), 0u);
                        call();
                        count();
                        return scene.counts == scene.CountsOf(shape);
                      });
    contest.Add({name, "scene", NameOf(target), scene.objects.size(),
                 scene.queries.size()},
                std::move(c));
  };
  const auto add_masks = [&](const std::string& name, ShapeKind shape,
                             auto call) {
    add(name + ", masks of many", shape, call, [&scene] {
      const std::size_t words = MaskWords(scene.objects.size());
      for (std::size_t i = 0; i < scene.masks.size(); ++i) {
        scene.counts[i / words] +=
            static_cast<std::size_t>(std::popcount(scene.masks[i]));
      }
    });
  };
  const auto masks_of = [&](ShapeKind shape, Schedule schedule) {
    return [&scene, shape, options = Options{schedule, target}] {
      scene.queries.With(shape, scene.objects.view(),
                         [&](const auto& view, const auto& queries) {
                           SurvivorMasks(view, queries, scene.masks, options);
                         });
    };
  };
  for (ShapeKind shape : kShapes) {
    add_masks(std::string(NameOf(shape)) + " flat", shape,
              masks_of(shape, Schedule::kFlat));
  }
  add_masks("AABB", ShapeKind::kAabb,
            masks_of(ShapeKind::kAabb, Schedule::kAuto));
  if (const LoopByHand loop = StagedByHandOf(target.name()); loop != nullptr) {
    add_masks("AABB by hand", ShapeKind::kAabb,
              [&scene, loop] { scene.MasksByHand(loop); });
  }
  const auto add_counts = [&](const char* name, ShapeKind shape,
                              const auto& world, auto queries) {
    const auto call = [&scene, &world, queries, target] {
      SurvivorCounts(world, queries, scene.counts, {.target = target});
    };
    add(name, shape, call, [] {});
  };
  add_counts("AABO uint8 refined, counts of many", ShapeKind::kAabo,
             scene.quantized, scene.queries.aabos());
  add_counts("simplex, counts of many", ShapeKind::kSimplex, scene.simplices,
             scene.queries.simplices());
  const auto add_pairs = [&](const char* name, const auto& world) {
    const auto call = [&scene, &world, target] {
      KeepResult(static_cast<std::uint32_t>(SurvivorPairs(
          world, scene.queries.aabos(), std::span(scene.of_queries), scene.ids,
          {.target = target})));
    };
    add(name, ShapeKind::kAabo, call, [&scene] {
      for (std::uint32_t query : scene.of_queries) ++scene.counts[query];
    });
  };
  add_pairs("AABO uint8 refined, pairs", scene.quantized);
  add_pairs("AABO floats, pairs", scene.objects);
}

// Minima of bytes: of quantized simplices, and by hand of random levels.
void AddLevels(Contest& contest, Scene& scene, Target target) {
  const std::size_t objects = scene.objects.size();
  const std::size_t words = MaskWords(objects);
  const std::size_t queries = scene.queries.size() / 4 * 4;
  const auto add = [&](const char* name, auto call, auto check) {
    Case c = CaseOfObjects(queries * objects, std::move(call));
    c.check = CheckOf(1, "an object that touches is not in the mask", check);
    contest.Add({name, "scene", NameOf(target), objects, queries},
                std::move(c));
  };
  const auto bounds =
      std::make_shared<QuantizedBounds<SimplexView3>>(scene.simplices);
  const auto call = [&scene, bounds, queries, words, target] {
    SurvivorMasks(*bounds, scene.queries.simplices().first(queries),
                  std::span(scene.masks).first(queries * words),
                  {.target = target});
  };
  add("simplex uint8, masks of many", call, [&scene, call, words](auto) {
    call();
    std::vector<std::uint64_t> mask(words);
    SurvivorMask(scene.simplices, scene.queries.simplices()[0], mask);
    return std::equal(
        mask.begin(), mask.end(), scene.masks.begin(),
        [](std::uint64_t a, std::uint64_t b) { return (a & ~b) == 0; });
  });
  const LevelsByHand loop = LevelsByHandOf(target.name());
  if (loop == nullptr) return;
  std::mt19937 random(1);
  std::array<std::vector<std::int8_t>, 4> planes;
  for (std::vector<std::int8_t>& plane : planes) {
    plane.resize(objects);
    for (std::int8_t& level : plane) level = static_cast<std::int8_t>(random());
  }
  std::vector<std::int8_t> values(queries * planes.size());
  for (std::int8_t& value : values) value = static_cast<std::int8_t>(random());
  const auto by_hand = [&scene, loop, planes, values, objects, words] {
    constexpr std::size_t kTile = 4096;
    for (std::size_t i = 0; i < objects; i += kTile) {
      std::array<const std::int8_t*, planes.size()> tile;
      for (std::size_t p = 0; p < tile.size(); ++p) tile[p] = &planes[p][i];
      for (std::size_t q = 0; q < values.size() / tile.size(); q += 4) {
        loop(tile.data(), std::min(kTile, objects - i),
             &values[q * tile.size()], &scene.masks[q * words + i / 64], words);
      }
    }
  };
  add("simplex uint8 by hand, masks of many", by_hand,
      [&scene, by_hand, planes, values](auto) {
        by_hand();
        for (std::size_t i = 0; i < 64; ++i) {
          bool is_kept = true;
          for (std::size_t p = 0; p < planes.size(); ++p) {
            is_kept &= planes[p][i] >= values[p];
          }
          if (is_kept != ((scene.masks[0] >> i & 1) != 0)) return false;
        }
        return true;
      });
}

}  // namespace

Tables RunKernels(Run& run) {
  Table table{"kernels",
              "one query, by working set",
              {Key("shape"), Key("set"), Key("target"), Key("schedule"),
               Key("objects"), Value("ns/object", "", 4), Value("GB/s", "", 1),
               Higher("% of reading", "", 0)}};
  for (WorkingSet* set : run.Sets({"L1", "L2", "L3", "memory"})) {
    for (ShapeKind shape : kShapes) AddRows(run, *set, shape, table);
  }
  table.notes = run.NotReached();
  return {table};
}

// What the layers cost on a small scan: reject.h, which checks its arguments,
// and kernels.h, which does not, beside loops written by hand for the target.
Tables RunTier(Run& run) {
  Table table{"tier",
              "a call of kernels.h and one of reject.h, beside loops by hand",
              {Key("shape"), Key("target"), Key("objects"), Key("by"),
               Value("time", "ns", 1), Lower("over by hand")}};
  for (std::size_t objects : {64, 256, 4096, 16384}) {
    WorkingSet set(run.Measured(), {"tier", objects});
    for (ShapeKind shape : kShapes) {
      for (Target target : run.targets) {
        AddTierRows(run, set, shape, target, table);
      }
    }
  }
  if (table.is_empty()) {
    table.notes.push_back(
        "There are loops by hand for AVX2 and AVX3 on x86-64, and for NEON on "
        "aarch64.");
  }
  return {table};
}

// Survivors of the three shapes.
Tables RunQuality(Run& run) {
  const Workload& workload = run.Measured();
  PerShape<std::size_t> survivors;
  for (const Aabo3& query : workload.queries) {
    AddSurvivors(workload.objects.view(), query, survivors);
  }
  Table table{"quality",
              "survivors in " + workload.name,
              {Key("shape"), Value("survivors", "", 0), Value("of a query"),
               Value("over AABB")}};
  for (ShapeKind shape : kShapes) {
    const auto count = static_cast<double>(survivors.Of(shape));
    table.Add({NameOf(shape), survivors.Of(shape),
               count / static_cast<double>(workload.queries.size()),
               survivors.aabb == 0
                   ? Cell()
                   : Cell(count / static_cast<double>(survivors.aabb))});
  }
  table.notes = {Grouped(workload.objects.size()) + " objects, " +
                 Grouped(workload.queries.size()) + " queries."};
  return {table};
}

// Many queries in a call.
Tables RunThroughput(Run& run) {
  Table table{"throughput",
              "many queries in a call: ns per object and query",
              {Key("what"), Key("set"), Key("target"), Key("objects"),
               Key("queries"), Lower("ns/pair", "", 4)}};
  constexpr std::size_t kQueries = 100;
  // Floats, quantized bounds with their records, levels, and a bit for each
  // query.
  constexpr std::size_t kBytes = 32 + 8 + 32 + 8 + kQueries / 8 + 1;
  std::size_t objects = run.MostObjects(10'000'000, /*of_quick=*/1'000'000);
  if (const std::size_t available = FreeMemory(); available != 0) {
    objects = std::min(objects, available / 4 / kBytes);
  }
  objects = objects / 64 * 64;  // as loops by hand need
  Workload made = MakeScene(objects, kQueries, run.options.seed);
  Scene scene{std::move(made.objects), ShapeQueries(made.queries)};
  const std::vector<std::size_t> counts = scene.CountsOf(ShapeKind::kAabo);
  scene.ids.resize(
      std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
  scene.of_queries.resize(scene.ids.size());
  Contest contest(run, "throughput");
  AddCalls(contest, scene, run.best());
  AddLevels(contest, scene, run.best());
  contest.Time(run.AtMostRepetitions(5));
  contest.AddTo(table);
  return {table};
}

}  // namespace halfspace::bench
