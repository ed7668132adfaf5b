// The paper's model, sections 2.4 and 2.5, with its quantities as it defines
// them (bench/measure/cost_model.h), against what is measured.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/cost_model.h"
#include "bench/measure/counts.h"
#include "bench/paper/work_count.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// The world of the verdict that is most like the paper's, whose objects take 2
// % of the side; that of a file.
const VerdictWorld& TypicalOf(const Verdict& verdict) {
  return *std::min_element(verdict.worlds().begin(), verdict.worlds().end(),
                           [](const VerdictWorld& a, const VerdictWorld& b) {
                             return std::abs(a.percent - 2.0) <
                                    std::abs(b.percent - 2.0);
                           });
}

// What one more plane costs an object in flat kernels.
double CompareNanoseconds(const VerdictWorld& world, std::size_t target) {
  const VerdictCell& cell = world.cells[target];
  // 4 planes and 6 planes.
  const double simplex = RangeOf(cell.FlatOf(ShapeKind::kSimplex)).median;
  const double box = RangeOf(cell.FlatOf(ShapeKind::kAabb)).median;
  return std::max(0.0, (box - simplex) / 2.0);
}

// Whether the paper's inequality predicts the winner, for each world.
Table DensityTable(const Verdict& verdict, std::size_t target,
                   const std::vector<ExactTest>& exact_tests) {
  const double compare = CompareNanoseconds(TypicalOf(verdict), target);
  Table table{"model",
              "kappa_box / N < 2 w_cmp / ((c - 1) w_full): then the simplex "
              "wins; " +
                  NameOf(verdict.targets()[target]) + ", L2",
              {Key("size"), Key("exact test"), Value("kappa box", "", 4),
               Value("c"), Value("kappa/N", "%", 4), Value("limit", "%", 4),
               Value("predicts"), Value("measured"),
               Value("break-even", "ns", 0), Value("kappa/N x that", "ns", 4)}};
  for (const VerdictWorld& world : verdict.worlds()) {
    const auto objects = static_cast<double>(world.objects);
    const double box = world.survivors.aabb / objects;
    // Of too few survivors nothing can be told.
    constexpr double kFewest = 30.0 / kTimedQueries;
    const bool is_counted = world.survivors.aabb >= kFewest;
    const double c =
        is_counted ? world.survivors.simplex / world.survivors.aabb : 1.0;
    const double saved = world.cells[target]
                             .Difference(ShapeKind::kAabb, ShapeKind::kSimplex)
                             .median;
    const double break_even = BreakEven(saved, (c - 1.0) * box);
    for (const ExactTest& exact : exact_tests) {
      const double limit = DensityLimit(c, compare, exact.ns.median);
      const Winner winner = WinnerOf(
          world.OverSimplex(ShapeKind::kAabb, target, exact.ns.median));
      table.Add({world.name(), exact.name, world.survivors.aabb,
                 is_counted ? Cell(c) : Cell(), 100.0 * box,
                 is_counted ? Cell(100.0 * limit) : Cell(),
                 NameOf(box < limit ? Winner::kSimplex : Winner::kBox),
                 NameOf(winner), is_counted ? Cell(break_even) : Cell(),
                 is_counted ? Cell(box * break_even) : Cell()});
    }
  }
  table.notes = {
      "kappa: survivors of a query of " + Grouped(TypicalOf(verdict).objects) +
          " objects. c: those of the simplex over those of the box. w_cmp: " +
          Fixed(compare, 4) +
          " ns, half of the time that six planes take longer than four. "
          "break-even: with a longer exact test the box wins.",
      "The limit holds for wide batches, where the box evaluates all six "
      "half-spaces. The box that is tested by axis skips some, so the limit "
      "is too high for it.",
      "A cube has c = 4.50 for boxes, by volume, and 3.55 for rays, by "
      "surface: computed from its bounding simplex."};
  return table;
}

Table EarlyOutTable(const WorkingSet& set, const Workload& workload) {
  Table table{"model: early-out",
              "share of batches of w objects that the first half-space rejects",
              {Key("w"), Value("(mean p)^w", "", 6),
               Value("mean of p_q^w", "", 6), Value("counted", "", 6)}};
  table.chart =
      Chart{"w", {"(mean p)^w", "mean of p_q^w", "counted"}, "", true, true};
  std::vector<float> maxima;
  for (const Aabo3& query : workload.queries) maxima.push_back(query.max[0]);
  for (std::size_t w = 1; w <= 64; w *= 2) {
    const EarlyOut shares =
        EarlyOutOf({set.view().min[0], set.objects()}, maxima, w);
    table.Add({w, shares.of_mean_p, shares.mean_of_p_w, shares.counted});
  }
  table.notes = {
      "p, the share of objects that the first half-space rejects, is between 0 "
      "and 1, depending on where the query is. So early-out fades far more "
      "slowly with w than (mean p)^w, the paper's model."};
  return table;
}

Table AdvantageTable(Run& run, const VerdictWorld& typical,
                     std::size_t verdict_target) {
  WorkingSet& set = run.SmallSet();
  const Workload& workload = run.Measured();
  WorkCounter counter(set.view());
  PerShape<double> survivors;
  for (const Aabo3& query : workload.queries) {
    counter.Add(query);
    AddSurvivors(set.view(), query, survivors);
  }
  const double pairs = static_cast<double>(set.objects()) *
                       static_cast<double>(workload.queries.size());
  const WorkCount work = counter.Average();
  const double compare = CompareNanoseconds(typical, verdict_target);
  const ExactTest exact = run.TheExactTest();
  const Target target = run.best();
  Table table{"model: Adv(w)",
              "ns that the simplex saves per object, with exact tests of " +
                  Fixed(exact.ns.median, 0) + " ns, " + NameOf(target) + ", L2",
              {Key("w"), Value("E[C] box"), Value("E[C] simplex"),
               Value("Adv(w)", "ns", 4), Value("measured", "ns", 4)}};
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    const std::size_t w = kWorkWidths[i];
    const ShapeCost box{work.aabb[i], survivors.aabb / pairs};
    const ShapeCost simplex{work.simplex[i], survivors.simplex / pairs};
    Row row = {w, box.half_spaces, simplex.half_spaces,
               Advantage(box, simplex, compare, exact.ns.median), Cell()};
    if (w >= target.lanes()) {
      const std::vector<Timing> ns = run.Time(
          {set.GatedCase("model/AABB", ShapeKind::kAabb, target, w),
           set.GatedCase("model/simplex", ShapeKind::kSimplex, target, w)});
      std::vector<double> saved = ns[0].samples;
      for (std::size_t s = 0; s < saved.size(); ++s) {
        saved[s] -= ns[1].samples[s] +
                    (simplex.survivors - box.survivors) * exact.ns.median;
      }
      row.back() = RangeOf(saved);
    }
    table.Add(std::move(row));
  }
  table.notes = {
      "E[C]: half-spaces evaluated per object, the sum of Pr[S_k], counted. "
      "Adv(w): (E[C] box - E[C] simplex) times w_cmp, " +
          Fixed(compare, 4) +
          " ns, minus the exact tests of the objects that only the simplex "
          "keeps. measured: the same with measured times.",
      "The paper says Adv(1) < 0. Its own times at w = 1, 2.31 and 3.28 ns, "
      "give a positive Adv(1)."};
  return table;
}

}  // namespace

Tables RunModel(Run& run) {
  run.Measured();
  if (run.machine.is_emulated) {
    return {EarlyOutTable(run.SmallSet(), run.Measured())};
  }
  const Verdict& verdict = run.TheVerdict();
  // The best target is the last of the verdict's.
  std::size_t target = verdict.targets().size() - 1;
  while (target > 0 && verdict.targets()[target] != run.best()) --target;
  std::vector<ExactTest> exact_tests = run.ExactTests();
  if (run.options.exact_ns) exact_tests.push_back(run.TheExactTest());
  Table exact{"model: exact tests",
              "ns of one exact test of two shapes near each other",
              {Key("test"), Value("time", "ns", 1)}};
  for (const ExactTest& test : exact_tests) exact.Add({test.name, test.ns});
  return {DensityTable(verdict, target, exact_tests),
          EarlyOutTable(run.SmallSet(), run.Measured()),
          AdvantageTable(run, TypicalOf(verdict), target), exact};
}

}  // namespace halfspace::bench
