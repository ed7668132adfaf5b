// Figure 12 of the paper: a batch of w objects stops after the first half-space
// that rejects all of them. One implementation for all shapes and widths. And
// what a branch costs: the same stages with and without.
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/paper/loops.h"
#include "bench/sections/contest.h"
#include "bench/sections/verdict.h"
#include "bench/worlds/workload.h"

namespace halfspace::bench {
namespace {

// Compares, for each size of objects, flat scans with stages in groups of 16,
// by branches and by lists of groups. Targets without vectors are left out,
// because they test a group object by object.
Tables BranchTables(Run& run) {
  Table times{"gate: branches",
              "the same stages in groups of 16 objects with branches or with "
              "lists of groups, L2",
              {Key("target"), Key("size", "%"), Key("shape"), Key("planes"),
               Value("flat", "ns", 3), Value("branches", "ns", 3),
               Value("lists", "ns", 3), Lower("branches / lists")}};
  Table ratios{
      "gate: by size",
      "both flat, with branches, with lists, and each the fastest of "
      "these",
      {Key("target"), Key("size", "%"), Key("way"), Higher("box / simplex")}};
  times.columns[1].digits = ratios.columns[1].digits = 1;
  // 20 000 queries take so long where one is slow.
  Effort effort = run.effort;
  if (!run.options.is_quick) effort.seconds_per_repetition *= 2.0;
  const std::vector<double> percents =
      run.options.is_quick
          ? std::vector<double>{2.0}
          : std::vector<double>{0.1, 0.3, 1.0, 2.0, 3.0, 10.0, 30.0};
  WorkingSetSize size = WorkingSetSizes(run.machine)[1];
  if (run.options.objects != 0) {
    size.objects = std::min(
        size.objects,
        std::max(kWidestGate, run.options.objects / kWidestGate * kWidestGate));
  }
  constexpr std::array<ShapeKind, 2> kCompared = {ShapeKind::kAabb,
                                                  ShapeKind::kSimplex};
  // And the planes of a stage.
  constexpr std::array<std::pair<Way, std::size_t>, 5> kWays = {
      {{Way::kFlat, 0},
       {Way::kBranches, 1},
       {Way::kLists, 1},
       {Way::kBranches, 2},
       {Way::kLists, 2}}};
  for (double percent : percents) {
    const Workload scene =
        SceneOfSize(percent / 100.0, size.objects, run.options.seed);
    WorkingSet set(scene, size);
    for (Target target : run.TargetsIn(set.name())) {
      const StagedScan staged = PaperLoopsFor(target).staged;
      if (target.lanes() < 4 || staged == nullptr) continue;
      Contest ns(run, "gate");
      for (ShapeKind shape : kCompared) {
        for (const auto& [way, planes] : kWays) {
          ns.Add(
              {NameOf(target), percent, NameOf(shape), NameOf(way), planes},
              set.LoopCase(shape, [=, way = way, planes = planes](auto... of) {
                staged(shape, way, planes, of...);
              }));
        }
      }
      ns.Time(effort);
      const std::size_t of_shape = kWays.size();
      for (std::size_t s = 0; s < kCompared.size(); ++s) {
        const std::size_t flat = s * of_shape;
        for (std::size_t planes : {1, 2}) {
          const std::size_t lists = flat + 2 * planes;
          times.Add(
              {NameOf(target), percent, NameOf(kCompared[s]), planes,
               ns.Median(flat), ns.Median(lists - 1), ns.Median(lists),
               RangeOf(RatiosOf(ns.timing(lists - 1), ns.timing(lists)))});
        }
      }
      // The fastest of some cases, for each of the two shapes.
      const auto add = [&](const char* way,
                           const std::vector<std::size_t>& cases) {
        const auto fastest = [&](std::size_t first) {
          std::size_t best = cases[0];
          for (std::size_t c : cases) {
            if (ns.Median(first + c) < ns.Median(first + best)) best = c;
          }
          return ns.timing(first + best);
        };
        ratios.Add({NameOf(target), percent, way,
                    Marked(RangeOf(RatiosOf(fastest(0), fastest(of_shape))))});
      };
      add("flat", {0});
      add("branches", {1, 3});
      add("lists", {2, 4});
      add("fastest", {0, 1, 2, 3, 4});
    }
  }
  if (times.rows.empty()) return {};
  times.notes = {
      "size: an object's side over the world's. planes: after how many "
      "half-spaces a group without a survivor skips the rest. [ ]: range of "
      "the repetitions."};
  ratios.notes = {
      "Stages of one or two planes, whichever are faster. *: the simplex wins. "
      "=: neither. [ ]: range of the repetitions."};
  return {times, ratios};
}

}  // namespace

Tables RunGate(Run& run) {
  WorkingSet& set = *run.Sets({"L2"}).at(0);
  Table table{"gate",
              "the paper's rule: early-out after every half-space, L2 (figure "
              "12)",
              {Key("target"), Key("w"), Value("AABB", "ns", 3),
               Value("simplex", "ns", 3), Value("AABO", "ns", 3),
               Higher("box / simplex")}};
  table.chart = Chart{"w", {"box / simplex"}, "target", true, true};
  std::vector<Target> targets = run.targets;
  std::reverse(targets.begin(), targets.end());
  for (Target target : targets) {
    for (std::size_t w = std::max<std::size_t>(1, target.lanes());
         w <= kWidestGate; w *= 2) {
      Contest ns(run, "gate");
      for (ShapeKind shape : kShapes) {
        ns.Add({NameOf(target), w, NameOf(shape)},
               GatedCase(set, shape, target, w));
      }
      ns.Time();
      table.Add({NameOf(target), w, ns.Median(0), ns.Median(1), ns.Median(2),
                 Marked(RangeOf(RatiosOf(ns.timing(0), ns.timing(1))))});
    }
  }
  table.notes = {
      "*: the simplex is faster. =: no difference. [ ]: range of the "
      "repetitions. The paper, on another machine: 2.31 ns (box) and 3.28 ns "
      "(simplex) at w = 1, and one crossing, at w of about 8."};
  Tables tables = BranchTables(run);
  tables.insert(tables.begin(), std::move(table));
  return tables;
}

}  // namespace halfspace::bench
