#include "bench/sections/verdict.h"

#include <algorithm>
#include <utility>

#include "bench/base/text.h"
#include "bench/measure/counts.h"
#include "bench/report/table.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"

namespace halfspace::bench {
namespace {

constexpr std::array<double, 6> kPercents = {0.1, 0.3, 1.0, 3.0, 10.0, 30.0};

PerShape<double> SurvivorsOf(const AaboView3& view,
                             const std::vector<Aabo3>& queries) {
  PerShape<double> sums;
  for (const Aabo3& query : queries) AddSurvivors(view, query, sums);
  for (double* sum : {&sums.aabb, &sums.simplex, &sums.aabo}) {
    *sum /= static_cast<double>(queries.size());
  }
  return sums;
}

// Places in a list of names: "0.1 %, 1 % to 30 %".
std::string RangesOf(const std::vector<std::size_t>& places,
                     const std::vector<VerdictWorld>& worlds) {
  std::string text;
  for (std::size_t i = 0; i < places.size();) {
    std::size_t last = i;
    while (last + 1 < places.size() && places[last + 1] == places[last] + 1) {
      ++last;
    }
    text += (text.empty() ? "" : ", ") + worlds[places[i]].name();
    if (last != i) text += " to " + worlds[places[last]].name();
    i = last + 1;
  }
  return text;
}

std::string LanesOf(Target target) {
  return target.lanes() <= 1 ? "1 lane"
                             : std::to_string(target.lanes()) + " lanes";
}

bool IsOfFile(const Verdict& verdict) {
  return verdict.worlds().front().percent == 0.0;
}

// From which target on the simplex wins at more sizes than the box.
std::string Headline(const Verdict& verdict) {
  std::size_t first = verdict.targets().size();
  for (std::size_t t = verdict.targets().size(); t-- > 0;) {
    std::size_t simplex = 0;
    std::size_t box = 0;
    for (const VerdictWorld& world : verdict.worlds()) {
      const Winner winner =
          WinnerOf(world.OverSimplex(ShapeKind::kAabb, t, 0.0));
      simplex += winner == Winner::kSimplex ? 1 : 0;
      box += winner == Winner::kBox ? 1 : 0;
    }
    if (simplex <= box) break;
    first = t;
  }
  return std::string("The simplex wins ") +
         (IsOfFile(verdict) ? "" : "at more sizes than the box ") +
         (first == verdict.targets().size()
              ? "on no target"
              : "from " + LanesOf(verdict.targets()[first]) + " on") +
         ". The paper predicts 8 to 16 lanes.";
}

// Where each wins on one target, in one line.
std::string SentenceOf(const Verdict& verdict, std::size_t target,
                       double exact_ns) {
  std::array<std::vector<std::size_t>, 3> where;
  for (std::size_t w = 0; w < verdict.worlds().size(); ++w) {
    const Winner winner = WinnerOf(
        verdict.worlds()[w].OverSimplex(ShapeKind::kAabb, target, exact_ns));
    where[static_cast<std::size_t>(winner)].push_back(w);
  }
  std::string text;
  for (Winner winner : {Winner::kSimplex, Winner::kBox, Winner::kNone}) {
    const auto& places = where[static_cast<std::size_t>(winner)];
    if (places.empty()) continue;
    const bool is_first = text.empty();
    text += is_first ? " " : "; ";
    text +=
        (winner == Winner::kNone ? "" : "the ") + std::string(NameOf(winner));
    if (is_first) text += " wins";
    if (!IsOfFile(verdict)) {
      text += " at " + RangesOf(places, verdict.worlds());
    }
  }
  const Target t = verdict.targets()[target];
  return NameOf(t) + ", " + LanesOf(t) + ":" + text + ".";
}

Table TableOf(const Verdict& verdict, std::string name, std::string title,
              double exact_ns) {
  Table table{std::move(name), std::move(title), {Key("size")}};
  for (Target target : verdict.targets()) {
    table.columns.push_back(Value(NameOf(target)));
  }
  for (const VerdictWorld& world : verdict.worlds()) {
    Row row = {world.name()};
    for (std::size_t t = 0; t < verdict.targets().size(); ++t) {
      const Ratio ratio = world.OverSimplex(ShapeKind::kAabb, t, exact_ns);
      const Winner winner = WinnerOf(ratio);
      row.push_back(Cell(ratio).With(winner == Winner::kSimplex ? Flag::kWinner
                                     : winner == Winner::kNone  ? Flag::kTie
                                                                : Flag::kNone));
    }
    table.Add(std::move(row));
  }
  for (std::size_t t = 0; t < verdict.targets().size(); ++t) {
    table.notes.push_back(SentenceOf(verdict, t, exact_ns));
  }
  return table;
}

}  // namespace

Winner WinnerOf(const Ratio& box_over_simplex) {
  if (box_over_simplex.low > 1.0) return Winner::kSimplex;
  if (box_over_simplex.high < 1.0) return Winner::kBox;
  return Winner::kNone;
}

const char* NameOf(Winner winner) {
  constexpr const char* kNames[] = {"simplex", "box", "neither"};
  return kNames[static_cast<std::size_t>(winner)];
}

std::size_t VerdictCell::BestOf(ShapeKind shape) const {
  std::size_t best = kContenders.size();
  for (std::size_t c = 0; c < kContenders.size(); ++c) {
    if (kContenders[c].shape != shape) continue;
    if (best == kContenders.size() ||
        RangeOf(ns[c]).median < RangeOf(ns[best]).median) {
      best = c;
    }
  }
  return best;
}

Ratio VerdictCell::Difference(ShapeKind more, ShapeKind less) const {
  std::vector<double> differences = ns[BestOf(more)];
  const std::vector<double>& others = ns[BestOf(less)];
  for (std::size_t g = 0; g < differences.size(); ++g) {
    differences[g] -= others[g];
  }
  return RangeOf(differences);
}

std::string VerdictWorld::name() const {
  if (percent == 0.0) return "file";
  return Fixed(percent, percent < 1.0 ? 1 : 0) + " %";
}

Ratio VerdictWorld::OverSimplex(ShapeKind shape, std::size_t target,
                                double exact_ns) const {
  const VerdictCell& cell = cells[target];
  const auto costs = [&](ShapeKind of) {
    std::vector<double> all = cell.ns[cell.BestOf(of)];
    for (double& ns : all) {
      ns += exact_ns * survivors.Of(of) / static_cast<double>(objects);
    }
    return all;
  };
  const std::vector<double> simplex = costs(ShapeKind::kSimplex);
  std::vector<double> ratios = costs(shape);
  for (std::size_t g = 0; g < ratios.size(); ++g) ratios[g] /= simplex[g];
  return RangeOf(ratios);
}

Verdict::Verdict(Run& run) : targets_(run.targets), effort_(run.effort) {
  // The narrowest first, as the question is from which width on.
  std::reverse(targets_.begin(), targets_.end());
  effort_.repetitions = std::min<std::size_t>(effort_.repetitions, 3);
  effort_.seconds_per_repetition /= 3.0;
  size_ = WorkingSetSizes(run.machine)[1];
  const auto add = [&](const Workload& workload, double percent) {
    const AaboWorld3 objects = ResizedTo(workload.objects, size_.objects);
    VerdictWorld world;
    world.percent = percent;
    world.objects = size_.objects;
    world.survivors = SurvivorsOf(objects.view(), workload.timed_queries);
    world.cells.resize(targets_.size());
    worlds_.push_back(std::move(world));
    workloads_.push_back(&workload);
  };
  if (run.input() != nullptr) {
    add(*run.input(), 0.0);
    return;
  }
  for (double percent : kPercents) {
    scenes_.push_back(
        SceneOfSize(percent / 100.0, size_.objects, run.options.seed));
    add(scenes_.back(), percent);
  }
}

Verdict::~Verdict() = default;

void Verdict::AddGroup(Run& run) {
  for (std::size_t w = 0; w < worlds_.size(); ++w) {
    sets_.push_back(std::make_unique<WorkingSet>(*workloads_[w], size_));
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      std::vector<Case> cases;
      for (const Contender& contender : kContenders) {
        cases.push_back(sets_.back()->LibraryCase(
            "verdict/" + worlds_[w].name() + "/" + NameOf(targets_[t]) + "/" +
                NameOf(contender.shape) + "/" + contender.schedule,
            contender.shape,
            {.schedule = contender.how, .target = targets_[t]}));
        // Answers do not change between groups.
        if (groups_ != 0) cases.back().check = nullptr;
      }
      const std::vector<Timing> timings = run.Time(cases, effort_);
      for (std::size_t c = 0; c < cases.size(); ++c) {
        worlds_[w].cells[t].ns[c].push_back(timings[c].Median());
      }
    }
  }
  ++groups_;
}

Tables RunVerdict(Run& run) {
  if (run.machine.is_emulated) {
    return {
        {"verdict",
         "simplex or box",
         {},
         {},
         {"Not measured: the CPU is emulated, and its times mean nothing."}}};
  }
  const Verdict& verdict = run.TheVerdict();
  const ExactTest exact = run.TheExactTest();
  const std::string what =
      "time of the best float box scan / time of the simplex scan";
  Tables tables = {
      TableOf(verdict, "verdict", what + ", one query, L2", 0.0),
      TableOf(verdict, "verdict: with exact tests",
              "the same with an exact test of " + Fixed(exact.ns.median, 0) +
                  " ns (" + exact.name + ") of each survivor",
              exact.ns.median)};
  tables[0].notes.insert(tables[0].notes.begin(), Headline(verdict));
  tables[0].notes.push_back(
      std::string(IsOfFile(verdict)
                      ? ""
                      : "size: an object's side over the world's. ") +
      "*: the simplex wins. =: neither. [ ]: range of " +
      std::to_string(verdict.groups()) + " groups.");
  if (run.is_page()) {
    tables[1].notes.clear();
    return tables;
  }
  Table times{"verdict: times",
              "ns per object, and the range of the groups",
              {Key("size"), Key("target"), Key("shape"), Key("schedule"),
               Value("time", "ns", 4), Value("over the simplex", "", 3)}};
  for (const VerdictWorld& world : verdict.worlds()) {
    for (std::size_t t = 0; t < verdict.targets().size(); ++t) {
      const VerdictCell& cell = world.cells[t];
      for (std::size_t c = 0; c < kContenders.size(); ++c) {
        std::vector<double> ratios = cell.ns[c];
        for (std::size_t g = 0; g < ratios.size(); ++g) {
          ratios[g] /= cell.ns[0][g];
        }
        times.Add({world.name(), NameOf(verdict.targets()[t]),
                   NameOf(kContenders[c].shape), kContenders[c].schedule,
                   RangeOf(cell.ns[c]), RangeOf(ratios)});
      }
    }
  }
  tables.push_back(std::move(times));
  if (IsOfFile(verdict)) return tables;
  Table chart{"verdict: by size",
              what + ", by the size of objects",
              {Key("target"), Key("size", "%"), Higher("box / simplex")}};
  chart.columns[1].digits = 1;
  chart.chart = Chart{"size", {"box / simplex"}, "target", true, true};
  for (std::size_t t = 0; t < verdict.targets().size(); ++t) {
    for (const VerdictWorld& world : verdict.worlds()) {
      chart.Add({NameOf(verdict.targets()[t]), world.percent,
                 world.OverSimplex(ShapeKind::kAabb, t, 0.0)});
    }
  }
  tables.push_back(std::move(chart));
  return tables;
}

}  // namespace halfspace::bench
