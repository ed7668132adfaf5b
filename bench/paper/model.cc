// The paper's model, sections 2.4 and 2.5, against what is measured.
#include "bench/paper/model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/groups.h"
#include "bench/paper/loops.h"
#include "bench/paper/work_count.h"
#include "bench/sections/contest.h"

namespace halfspace::bench {
namespace {

// The world of the verdict whose objects take 2 % of the side, as the paper's
// do. A file has only one world.
const VerdictWorld& TypicalOf(const Verdict& verdict) {
  const VerdictWorld* typical = &verdict.worlds()[0];
  for (const VerdictWorld& world : verdict.worlds()) {
    if (world.percent == 2.0) typical = &world;
  }
  return *typical;
}

// What one more plane costs an object in flat kernels of 4 and 6 planes.
double CompareNanoseconds(const VerdictWorld& world, std::size_t target) {
  return std::max(0.0, (world.TimingOf(target, kFlatBox).Median() -
                        world.TimingOf(target, kFlatSimplex).Median()) /
                           2.0);
}

// Whether the paper's inequality predicts the winner, for each world.
Table DensityTable(const Verdict& verdict, std::size_t target,
                   const ExactTest& exact) {
  const double compare = CompareNanoseconds(TypicalOf(verdict), target);
  Table table{
      "model",
      "kappa_box / N < 2 w_cmp / ((c - 1) w_full): then the simplex "
      "wins; " +
          NameOf(verdict.columns()[target].target) + ", L2",
      {Key("size"), Key("exact test"), Value("kappa box", "", 4), Value("c"),
       Value("kappa/N", "%", 4), Value("limit", "%", 4), Value("predicts"),
       Value("measured"), Value("break-even", "ns", 0)}};
  for (const VerdictWorld& world : verdict.worlds()) {
    const auto objects = static_cast<double>(world.objects);
    const PerShape<double> survivors = world.MeanSurvivors();
    const double box = survivors.aabb / objects;
    // Too few survivors tell nothing.
    constexpr double kFewest = 30.0 / kTimedQueries;
    const bool is_counted = survivors.aabb >= kFewest;
    const double c = is_counted ? survivors.simplex / survivors.aabb : 1.0;
    std::vector<double> saved;
    for (const GroupTimes& group : world.times[target]) {
      saved.push_back(group.box - group.simplex);
    }
    const double break_even =
        BreakEven(GroupRange(saved).median, (c - 1.0) * box);
    const double limit = DensityLimit(c, compare, exact.ns);
    const Winner winner = WinnerOf(world.BoxOverSimplex(target, exact.ns));
    table.Add({world.name(), exact.name, survivors.aabb,
               is_counted ? Cell(c) : Cell(), 100.0 * box,
               is_counted ? Cell(100.0 * limit) : Cell(),
               NameOf(box < limit ? Winner::kSimplex : Winner::kBox),
               NameOf(winner), is_counted ? Cell(break_even) : Cell()});
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
      "c is less for the largest objects because queries near the edge of the "
      "world have no objects beyond it, where the simplex would keep them. In "
      "a world without an edge c does not depend on the size of objects."};
  return table;
}

Table EarlyOutTable(const WorkingSet& set, const Workload& workload) {
  Table table{"model: early-out",
              "share of batches of w objects that the first half-space rejects",
              {Key("w"), Value("(mean p)^w", "", 3),
               Value("mean of p_q^w", "", 3), Value("counted", "", 3)}};
  table.chart =
      Chart{"w", {"(mean p)^w", "mean of p_q^w", "counted"}, "", true};
  std::vector<float> maxima;
  for (const Aabo3& query : workload.timed_queries) {
    maxima.push_back(query.max[0]);
  }
  for (std::size_t w = 1; w <= 64; w *= 2) {
    const EarlyOut shares =
        EarlyOutOf({set.view().min[0], set.objects()}, maxima, w);
    table.Add({w, shares.of_mean_p, shares.mean_of_p_w, shares.counted});
  }
  table.notes = {
      "p, the share of objects that the first half-space rejects, is between 0 "
      "and 1, depending on where the query is. So early-out fades far more "
      "slowly with w than (mean p)^w, the paper's model. " +
      Grouped(maxima.size()) +
      " queries. [ ]: two standard errors of their mean."};
  return table;
}

Table AdvantageTable(Run& run, const VerdictWorld& typical,
                     std::size_t verdict_target) {
  WorkingSet& set = run.SmallSet();
  const Workload& workload = run.Measured();
  WorkCounter counter(set.view());
  for (const Aabo3& query : workload.queries) counter.Add(query);
  const WorkCount work = counter.Average();
  const double compare = CompareNanoseconds(typical, verdict_target);
  const ExactTest exact = run.TheExactTest();
  const Target target = run.best();
  // With the share of pairs that survive.
  const auto cost_of = [&](ShapeKind shape, double half_spaces) -> ShapeCost {
    return {half_spaces,
            static_cast<double>(counter.survivors().Of(shape)) /
                static_cast<double>(set.objects() * workload.queries.size())};
  };
  const auto advantage = [&](double of_box, double of_simplex) {
    return Advantage(cost_of(ShapeKind::kAabb, of_box),
                     cost_of(ShapeKind::kSimplex, of_simplex), compare,
                     exact.ns);
  };
  const auto by_formula = [&](ShapeKind shape, std::size_t w) {
    return HalfSpacesByFormula(counter.Reached(shape), static_cast<double>(w));
  };
  Table table{"model: Adv(w)",
              "ns that the simplex saves per object, with exact tests of " +
                  Fixed(exact.ns, 0) + " ns, " + NameOf(target) + ", L2",
              {Key("w"), Value("E[C] box"), Value("E[C] simplex"),
               Value("by 1 - p^w", "ns", 3), Value("Adv(w)", "ns", 3),
               Value("measured", "ns", 3)}};
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    const std::size_t w = kWorkWidths[i];
    Row row = {w,
               work.aabb[i],
               work.simplex[i],
               advantage(by_formula(ShapeKind::kAabb, w),
                         by_formula(ShapeKind::kSimplex, w)),
               advantage(work.aabb[i], work.simplex[i]),
               Cell()};
    if (w >= target.lanes()) {
      Contest ns(run, "model");
      for (ShapeKind shape : {ShapeKind::kAabb, ShapeKind::kSimplex}) {
        ns.Add({NameOf(shape), w}, GatedCase(set, shape, target, w));
      }
      ns.Time();
      std::vector<double> saved = ns.timing(0).samples;
      for (std::size_t s = 0; s < saved.size(); ++s) {
        // With no half-spaces, advantage() is what the exact tests save.
        saved[s] += advantage(0.0, 0.0) - ns.timing(1).samples[s];
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
          "keeps. by 1 - p^w: the same with the paper's Pr[S_k] = 1 - p^w, "
          "where p is the share of objects that the half-spaces before k "
          "reject. measured: with measured times of a branch after each "
          "half-space.",
      "The paper says Adv(1) < 0. So do its own times at w = 1: 2.31 ns for "
      "the box and 3.28 ns for the simplex."};
  return table;
}

}  // namespace

Tables RunModel(Run& run) {
  run.Measured();
  if (run.machine.is_emulated) {
    return {EarlyOutTable(run.SmallSet(), run.Measured())};
  }
  const Verdict& verdict = run.TheVerdict();
  const std::size_t target = verdict.best_column();
  return {DensityTable(verdict, target, run.TheExactTest()),
          EarlyOutTable(run.SmallSet(), run.Measured()),
          AdvantageTable(run, TypicalOf(verdict), target)};
}

}  // namespace halfspace::bench
