// Many queries in a call, next to what limits them: one loop over kinds of
// worlds and calls.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "bench/sections/contest.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"
#include "halfspace/quantized.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kManyObjects = 10'000'000;
constexpr std::size_t kQuickManyObjects = 1'000'000;
constexpr std::size_t kManyQueries = 100;
constexpr std::size_t kQueriesInL1 = 16;

// A kind of world: objects, and the queries that a call answers.
struct Kind {
  std::string name;
  AaboWorld3 objects;
  ShapeQueries queries;
  QuantizedWorld<AaboView3> quantized = {};
  std::array<std::vector<std::size_t>, kShapes.size()> counts = {};

  // Of each query, by a flat scan.
  const std::vector<std::size_t>& CountsOf(ShapeKind shape) {
    std::vector<std::size_t>& of = counts[static_cast<std::size_t>(shape)];
    if (of.empty()) {
      of.resize(queries.size());
      queries.With(
          shape, objects.view(), [&](const auto& view, const auto& some) {
            SurvivorCounts(view, some, of, {.schedule = Schedule::kFlat});
          });
    }
    return of;
  }
};

// What a call writes.
struct Output {
  std::vector<std::uint64_t> masks;
  std::vector<std::uint32_t> queries;
  std::vector<std::uint32_t> ids;
  std::vector<std::size_t> counts;
};

// How a call answers all queries, and how many survivors it found of each.
struct Call {
  std::string name;
  ShapeKind shape;
  std::function<void(Kind& kind, Target target, Output& to)> run;
  std::function<void(Output& to)> count = [](Output&) {};
};

void CountMasks(Output& to) {
  const std::size_t words = to.masks.size() / to.counts.size();
  for (std::size_t q = 0; q < to.counts.size(); ++q) {
    to.counts[q] = 0;
    for (std::size_t w = 0; w < words; ++w) {
      to.counts[q] +=
          static_cast<std::size_t>(std::popcount(to.masks[q * words + w]));
    }
  }
}

Call MasksCall(ShapeKind shape) {
  return {
      std::string(NameOf(shape)) + " flat, masks of many", shape,
      [shape](Kind& kind, Target target, Output& to) {
        to.masks.resize(kind.queries.size() * MaskWords(kind.objects.size()));
        kind.queries.With(
            shape, kind.objects.view(),
            [&](const auto& view, const auto& queries) {
              SurvivorMasks(view, queries, to.masks,
                            {.schedule = Schedule::kFlat, .target = target});
            });
      },
      &CountMasks};
}

Call CountsCall() {
  return {"simplex, counts of many", ShapeKind::kSimplex,
          [](Kind& kind, Target target, Output& to) {
            SurvivorCounts(kind.objects.view().simplex(),
                           kind.queries.simplices(), to.counts,
                           {.target = target});
          }};
}

Call RefinedCountsCall() {
  return {"AABO uint8 refined, counts of many", ShapeKind::kAabo,
          [](Kind& kind, Target target, Output& to) {
            SurvivorCounts(kind.quantized, kind.queries.aabos(), to.counts,
                           {.target = target});
          }};
}

// Every surviving pair. world_of(kind) is what it scans.
template <typename WorldOf>
Call PairsCall(const char* name, WorldOf world_of) {
  return {name, ShapeKind::kAabo,
          [world_of](Kind& kind, Target target, Output& to) {
            if (to.ids.empty()) {
              const auto& counts = kind.CountsOf(ShapeKind::kAabo);
              to.ids.resize(std::accumulate(counts.begin(), counts.end(),
                                            std::size_t{1}));
              to.queries.resize(to.ids.size());
            }
            const std::size_t pairs =
                SurvivorPairs(world_of(kind), kind.queries.aabos(), to.queries,
                              to.ids, {.target = target});
            to.queries.back() = static_cast<std::uint32_t>(pairs);
          },
          [](Output& to) {
            std::fill(to.counts.begin(), to.counts.end(), std::size_t{0});
            const std::size_t pairs =
                std::min<std::size_t>(to.queries.back(), to.ids.size() - 1);
            for (std::size_t i = 0; i < pairs; ++i) ++to.counts[to.queries[i]];
          }};
}

// The loop that one would write instead, and that a compiler vectorises.
Call VectorisedCall(CountSimplices TargetLoops::*loop) {
  return {"baseline: vectorised simplex", ShapeKind::kSimplex,
          [loop](Kind& kind, Target target, Output& to) {
            const SimplexView3 view = kind.objects.view().simplex();
            (LoopsFor(target).*
             loop)({{view.min[0], view.min[1], view.min[2], view.min[3]},
                    view.size,
                    kind.queries.simplices().front().max.data(),
                    kind.queries.size(),
                    to.counts.data()});
          }};
}

// A row: the fastest of some calls on a world. With `of`, the row that is its
// ceiling, a place in the same list.
struct Line {
  Kind* kind;
  std::vector<Call> calls;
  std::optional<std::size_t> of = {};
  const char* suffix = "";
};

Case CaseOf(Kind& kind, const Call& call, Target target) {
  const auto to = std::make_shared<Output>();
  to->counts.resize(kind.queries.size());
  const std::size_t pairs = kind.queries.size() * kind.objects.size();
  const std::size_t rounds = std::max<std::size_t>(1, kObjectsPerRun / pairs);
  Case c;
  c.name = "throughput/" + kind.name + "/" + NameOf(target) + "/" + call.name;
  c.group = "throughput";
  c.items = static_cast<double>(rounds * pairs);
  c.run = [&kind, call, target, to, rounds] {
    for (std::size_t i = 0; i < rounds; ++i) call.run(kind, target, *to);
  };
  c.check = [&kind, call, target, to]() -> std::string {
    call.run(kind, target, *to);
    call.count(*to);
    const std::vector<std::size_t>& expected = kind.CountsOf(call.shape);
    for (std::size_t q = 0; q < expected.size(); ++q) {
      if (to->counts[q] != expected[q]) {
        return "query " + std::to_string(q) + ": " +
               std::to_string(to->counts[q]) + " survivors, not " +
               std::to_string(expected[q]);
      }
    }
    return {};
  };
  return c;
}

void AddRows(Run& run, const std::vector<Line>& lines, Target target,
             Table& table) {
  std::vector<Case> cases;
  for (const Line& line : lines) {
    for (const Call& call : line.calls) {
      cases.push_back(CaseOf(*line.kind, call, target));
    }
  }
  Effort effort = run.effort;
  effort.repetitions = std::min<std::size_t>(effort.repetitions, 5);
  const std::vector<Timing> timings = run.Time(cases, effort);
  std::vector<const Timing*> fastest;
  std::vector<std::string> names;
  std::size_t next = 0;
  for (const Line& line : lines) {
    const auto first = timings.begin() + static_cast<std::ptrdiff_t>(next);
    const auto best = std::min_element(
        first, first + static_cast<std::ptrdiff_t>(line.calls.size()),
        [](const Timing& a, const Timing& b) {
          return a.Median() < b.Median();
        });
    next += line.calls.size();
    fastest.push_back(&*best);
    names.push_back(line.calls[static_cast<std::size_t>(best - first)].name +
                    line.suffix);
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    Row row = {names[i],
               lines[i].kind->name,
               NameOf(target),
               lines[i].kind->objects.size(),
               lines[i].kind->queries.size(),
               fastest[i]->Median(),
               Cell(),
               Cell()};
    if (lines[i].of) {
      row[6] = names[*lines[i].of];
      row[7] = RatioOf(*fastest[*lines[i].of], *fastest[i]).Percent();
    }
    table.Add(std::move(row));
  }
}

AaboView3 FloatsOf(const Kind& kind) { return kind.objects.view(); }
const QuantizedWorld<AaboView3>& QuantizedOf(const Kind& kind) {
  return kind.quantized;
}

// 100 queries a call, next to 16 in the first-level cache and to the loop that
// one would write instead.
void RunScene(Run& run, Table& table) {
  const std::size_t objects = run.is_quick() ? kQuickManyObjects : kManyObjects;
  // Floats, quantized bounds with their records, and a bit for each query.
  constexpr std::size_t kBytes = 32 + 8 + 32 + kManyQueries / 8 + 1;
  const std::size_t available = run.machine.available_memory;
  if (run.machine.is_emulated ||
      (available != 0 && objects * kBytes > available / 4)) {
    table.notes.push_back(
        "Not measured: many queries. Their scene needs " +
        Mebibytes(objects * kBytes) +
        ", more than a quarter of the free memory, or the CPU is emulated.");
    return;
  }
  Workload made =
      MakeScene(objects, kManyQueries, run.options.seed, [](double) {});
  Kind scene{"scene", std::move(made.objects), ShapeQueries(made.queries)};
  scene.quantized = QuantizedWorld<AaboView3>(scene.objects);
  const Workload& workload = run.Measured();
  std::vector<Aabo3> few;
  for (std::size_t q = 0; q < kQueriesInL1; ++q) {
    few.push_back(workload.queries[q % workload.queries.size()]);
  }
  for (Target target : run.WidthTargets()) {
    for (ShapeKind shape : kShapes) {
      const std::size_t record = PlaneCountOf(shape) * sizeof(float);
      const std::size_t in_half =
          run.machine.CacheBytes(1) / 2 / record / 64 * 64;
      Kind in_cache{
          "L1", ResizedTo(workload.objects, std::max<std::size_t>(64, in_half)),
          ShapeQueries(few)};
      AddRows(run,
              {{&in_cache, {MasksCall(shape)}, {}, ", again"},
               {&scene, {MasksCall(shape)}, 0}},
              target, table);
    }
    AddRows(run,
            {{&scene, {RefinedCountsCall()}},
             {&scene, {CountsCall()}},
             {&scene, {PairsCall("AABO uint8 refined, pairs", &QuantizedOf)}},
             {&scene, {PairsCall("AABO floats, pairs", &FloatsOf)}},
             {&scene,
              {VectorisedCall(&TargetLoops::count_by_or),
               VectorisedCall(&TargetLoops::count_by_and)}}},
            target, table);
  }
}

}  // namespace

Tables RunThroughput(Run& run) {
  Table table{
      "throughput",
      "ns per object and query, next to its ceiling",
      {Key("what"), Key("set"), Key("target"), Key("objects"), Key("queries"),
       Value("ns/pair", "", 4), Value("ceiling"), Value("% of it", "", 0)}};
  RunScene(run, table);
  return {table};
}

}  // namespace halfspace::bench
