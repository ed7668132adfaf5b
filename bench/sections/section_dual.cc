#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/second_reads.h"
#include "bench/sections/alternatives.h"
#include "bench/sections/plan.h"
#include "halfspace/fit.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kCountedPairs = std::size_t{1} << 27;
constexpr std::size_t kFewestCounted = 8;

// The bounds of boxes, those of a workload's first objects: content that is
// axis-aligned.
Workload BoxesOfWorkload(const Workload& workload, std::size_t most) {
  Workload boxes{"boxes of " + workload.name, {}, {}};
  const std::size_t objects = std::min(most, workload.objects.size());
  boxes.objects.Reserve(objects);
  for (std::size_t i = 0; i < objects; ++i) {
    boxes.objects.Push(BoundAabb(workload.objects.Get(i).aabb()));
  }
  for (const Aabo3& query : workload.timed_queries) {
    boxes.timed_queries.push_back(BoundAabb(query.aabb()));
  }
  return boxes;
}

// Rejects by the simplex, then tests the maxima of each survivor by itself.
void RejectAndRefine(WorkingSet& set, const Aabo3& query, Target target) {
  const AaboView3& view = set.view();
  RejectMask(view.simplex(), query.down(), set.mask(), {.target = target});
  for (std::size_t w = 0; w < set.mask().size(); ++w) {
    std::uint64_t& rejected = set.mask()[w];
    for (std::uint64_t left = ~rejected; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(left));
      const std::size_t i = 64 * w + bit;
      bool is_rejected = false;
      for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
        is_rejected |= view.max[k][i] < query.min[k];
      }
      rejected |= std::uint64_t{is_rejected} << bit;
    }
  }
}

void CountSecondReads(WorkingSet& set, const std::vector<Aabo3>& queries,
                      DualRow& row) {
  const std::size_t counted = std::min(
      queries.size(), std::max(kFewestCounted, kCountedPairs / set.objects()));
  std::array<std::size_t, 3> reads{};
  const std::array<std::size_t, 3> widths = {
      1, std::min<std::size_t>(row.lanes, 64), 64};
  for (std::size_t q = 0; q < counted; ++q) {
    SurvivorMask(set.view().simplex(), queries[q].down(), set.mask());
    for (std::size_t i = 0; i < widths.size(); ++i) {
      reads[i] += BatchesWithSurvivor(set.mask(), widths[i]);
    }
  }
  const auto share = [&](std::size_t i) {
    return static_cast<double>(reads[i] * widths[i]) /
           static_cast<double>(set.objects() * counted);
  };
  row.second_of_1 = share(0);
  row.second_of_lanes = share(1);
  row.second_of_64 = share(2);
}

void PlanRow(Plan<DualRow>& plan, WorkingSet& set, const Workload& content,
             Target target) {
  DualRow row;
  row.content = content.name;
  row.working_set = set.name();
  row.target = target.name();
  row.lanes = target.lanes();
  row.objects = set.objects();
  CountSecondReads(set, content.timed_queries, row);
  const std::string prefix =
      "dual/" + row.content + "/" + row.working_set + "/" + row.target + "/";
  const auto add = [&](Case c) {
    c.group = prefix;
    return plan.AddCase(std::move(c));
  };
  const std::size_t first = add(set.LibraryCase(
      prefix + "simplex", ShapeKind::kSimplex, {.target = target}));
  add(set.MakeCase(prefix + "refined", ShapeKind::kAabo,
                   [&set, target](const Aabo3& query) {
                     RejectAndRefine(set, query, target);
                   }));
  add(set.LibraryCase(prefix + "flat", ShapeKind::kAabo,
                      {.schedule = Schedule::kFlat, .target = target}));
  add(set.LibraryCase(prefix + "staged", ShapeKind::kAabo,
                      {.schedule = Schedule::kStaged, .target = target}));
  plan.AddRow(std::move(row), [first](const Timings& timings, DualRow& timed) {
    const Timing& simplex = timings[first];
    const Timing& refined = timings[first + 1];
    const Timing& flat = timings[first + 2];
    const Timing& staged = timings[first + 3];
    timed.simplex_ns = simplex.Median();
    timed.refined_ns = refined.Median();
    timed.flat_ns = flat.Median();
    timed.staged_ns = staged.Median();
    timed.staged_over_flat = RatioOf(staged, flat);
    timed.refined_over_staged = RatioOf(refined, staged);
    timed.staged_over_simplex = RatioOf(staged, simplex);
  });
}

void RunContent(const Workload& content, const std::vector<WorkingSet*>& sets,
                bool is_quick, const Context& context, DualResult& result) {
  Plan<DualRow> plan;
  for (WorkingSet* set : sets) {
    for (Target target : context.targets) {
      if (IsMeasuredIn(set->name(), target, is_quick, context)) {
        PlanRow(plan, *set, content, target);
      }
    }
  }
  plan.Run(context.effort, context, result.rows);
}

}  // namespace

DualResult RunDual(const Workload& workload,
                   const std::vector<WorkingSet*>& sets,
                   const std::vector<WorkingSetSize>& sizes, bool is_quick,
                   const Context& context) {
  constexpr std::size_t kParts = 2;
  DualResult result;
  context.progress.BeginPart(0, kParts);
  RunContent(workload, sets, is_quick, context, result);
  context.progress.BeginPart(1, kParts);
  std::size_t most = 0;
  for (const WorkingSetSize& size : sizes) most = std::max(most, size.objects);
  const Workload boxes = BoxesOfWorkload(workload, most);
  std::vector<std::unique_ptr<WorkingSet>> owned;
  std::vector<WorkingSet*> box_sets;
  for (const WorkingSetSize& size : sizes) {
    owned.push_back(std::make_unique<WorkingSet>(boxes, size));
    box_sets.push_back(owned.back().get());
  }
  RunContent(boxes, box_sets, is_quick, context, result);
  return result;
}

}  // namespace halfspace::bench
