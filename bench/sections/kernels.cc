// Every shape, target, schedule and working set, against reading the planes.
#include "halfspace/kernels.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/baselines/by_hand.h"
#include "bench/inner/target_loops.h"
#include "bench/sections/contest.h"
#include "bench/worlds/working_set.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

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
  }
  contest.Time();
  const double bytes = static_cast<double>(PlaneCountOf(shape) * sizeof(float));
  contest.AddTo(table, [&](std::size_t i) -> Row {
    const Timing& timing = contest.timing(i);
    return {SpreadOf(timing), bytes / timing.Median(),
            RatioOf(contest.fastest(), timing).Percent()};
  });
}

Kernels<float>::OfBound KernelsFor(ShapeKind shape, Target target) {
  const Kernels<float>& kernels = KernelsOf<float>(target);
  return shape == ShapeKind::kAabb      ? kernels.boxes3
         : shape == ShapeKind::kSimplex ? kernels.simplices3
                                        : kernels.octahedra3;
}

void AddTierRows(Run& run, WorkingSet& set, ShapeKind shape, Target target,
                 Table& table) {
  const LoopByHand by_hand = LoopByHandOf(shape, target.name());
  if (by_hand == nullptr) return;
  // Of each query, its values one after the other, and a mask that survives.
  const std::size_t count = PlaneCountOf(shape);
  std::vector<float> values;
  for (const Aabo3& query : set.queries()) {
    const std::vector<float> of_query = QueryOf(shape, query);
    values.insert(values.end(), of_query.begin(), of_query.end());
  }
  const std::vector<const float*> planes = PlanesOf(shape, set.view());
  const auto unchecked = [&](LoopByHand loop) {
    return set.CallCase(shape, [&, loop](std::size_t q, std::uint64_t* mask) {
      loop(planes.data(), set.objects(), &values[q * count], mask);
    });
  };
  const auto checked = WithShape(
      shape, set.view(), set.queries().front(),
      [&]<typename Query>(const auto& view, const Query& /*query*/) {
        std::vector<Query> queries;
        for (const Aabo3& query : set.queries()) {
          queries.push_back(SeenAs<Query>(query));
        }
        return set.CallCase(shape, [view, target, queries = std::move(queries)](
                                       std::size_t q, std::uint64_t* mask) {
          SurvivorMask(view, queries[q], {mask, MaskWords(view.size)},
                       {.target = target});
        });
      });
  Contest contest(run, "tier");
  const auto add = [&](const char* by, Case c, Who who = Who::kOurs) {
    contest.Add({NameOf(shape), NameOf(target), set.objects(), by},
                std::move(c), who);
  };
  add("by hand", unchecked(by_hand), Who::kCompetitor);
  add("kernels.h", unchecked(KernelsFor(shape, target).one));
  add("reject.h", checked);
  contest.Time();
  contest.AddTo(table, [&](std::size_t i) -> Row {
    return {SpreadOf(contest.timing(i)),
            RatioOf(contest.timing(i), contest.fastest())};
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

// A call of kernels.h, and the checked one of reject.h, beside loops that are
// written by hand for the target.
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
  const AaboView3 view = workload.objects.view();
  PerShape<std::size_t> survivors;
  double done = 0.0;
  for (const Aabo3& query : workload.queries) {
    AddSurvivors(view, query, survivors);
    run.progress.Update(++done / static_cast<double>(workload.queries.size()));
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

}  // namespace halfspace::bench
