#include "bench/sections/verdict.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "bench/base/text.h"
#include "bench/measure/groups.h"
#include "bench/report/table.h"
#include "bench/sections/contest.h"
#include "bench/worlds/workload.h"

namespace halfspace::bench {
namespace {

// 2 % is the paper's.
constexpr std::array<double, 7> kPercents = {0.1, 0.3,  1.0, 2.0,
                                             3.0, 10.0, 30.0};

constexpr std::size_t kRepetitions = 6;

// Two digits of a percentage: "0.84", "3.4", "12"; "0.1", "3" of a row.
std::string PercentText(double percent) {
  std::ostringstream text;
  text.precision(2);
  text << percent;
  return text.str();
}

// An end of a range of sizes, of which some were measured.
std::string EndText(double percent, std::span<const double> sizes) {
  if (percent == 0.0) return "< " + PercentText(sizes.front());
  if (percent == kInfinity) return "> " + PercentText(sizes.back());
  return PercentText(percent);
}

// "3.4 % [3.1, 3.8]"
std::string SizeText(const Ratio& size, std::span<const double> sizes) {
  return EndText(size.median, sizes) + " % [" + EndText(size.low, sizes) +
         ", " + EndText(size.high, sizes) + "]";
}

constexpr const char* kOfSide = " of the world's side";

// From which size on something is so.
std::string FromText(const Ratio& from, std::span<const double> sizes) {
  const bool is_never = from.low == kInfinity;
  if (!is_never && from.high != 0.0) return SizeText(from, sizes) + kOfSide;
  return std::string(is_never ? "(at no size" : "(at every size") +
         " measured, " + PercentText(sizes.front()) + " to " +
         PercentText(sizes.back()) + " %)";
}

std::vector<std::string> LeadOf(const Verdict& verdict, double exact_ns) {
  // "  AVX2, 8       " and what is measured of it.
  const auto line = [&](std::size_t c, bool is_exact) {
    std::string name = "  " + verdict.columns()[c].name + " ";
    name.resize(std::max<std::size_t>(16, name.size()), ' ');
    if (verdict.is_of_file()) {
      const double exact = is_exact ? exact_ns : 0.0;
      return name + RatioText(verdict.worlds()[0].BoxOverSimplex(c, exact));
    }
    const auto text = is_exact ? &BoxAgainText : &SimplexText;
    return name + text(verdict.CrossingsOf(c, is_exact), verdict.sizes());
  };
  std::vector<std::string> lines = {
      verdict.is_of_file()
          ? "The box scan takes so many times as long as the simplex scan:"
          : "The simplex scan is faster than the box scan for objects larger "
            "than"};
  for (std::size_t c = 0; c < verdict.columns().size(); ++c) {
    lines.push_back(line(c, false));
  }
  lines.push_back(
      "If each kept object costs an exact test of " +
      Fixed(exact_ns, exact_ns < 9.5 ? 1 : 0) + " ns" +
      (verdict.is_of_file() ? ":" : ", the box is faster again from"));
  lines.push_back(line(verdict.best_column(), true));
  return lines;
}

// The ratios of each world and column.
Table TableOf(Run& run, std::string name, std::string title, double exact_ns) {
  const Verdict& verdict = run.TheVerdict();
  Table table{std::move(name),
              std::move(title),
              {verdict.is_of_file() ? Key("size") : Key("size", "%")}};
  table.columns[0].digits = 1;
  for (const VerdictColumn& column : verdict.columns()) {
    table.columns.push_back(Higher(column.name));
  }
  for (const VerdictWorld& world : verdict.worlds()) {
    Row row = {verdict.is_of_file() ? Cell("file") : Cell(world.percent)};
    for (std::size_t c = 0; c < verdict.columns().size(); ++c) {
      row.push_back(Marked(world.BoxOverSimplex(c, exact_ns)));
    }
    table.Add(std::move(row));
  }
  if (verdict.is_of_file()) {
    const std::size_t own = run.input()->objects.size();
    if (const std::size_t all = verdict.worlds()[0].objects; own < all) {
      table.notes.push_back("The file has " + Grouped(own) +
                            " objects. They are repeated up to " +
                            Grouped(all) + ", which fill half of L2.");
    }
    return table;
  }
  table.notes.push_back("size: an object's side over the world's.");
  table.chart = Chart{"size", {}, "", true, true};
  for (std::size_t c = 0; c < verdict.columns().size(); ++c) {
    table.chart->y.push_back(verdict.columns()[c].name);
    // Unless it lies beyond the sizes that were measured.
    const double from = verdict.CrossingsOf(c, false).from.median;
    if (exact_ns == 0.0 && from > 0.0 && std::isfinite(from)) {
      table.chart->marks.push_back({verdict.columns()[c].name, from});
    }
  }
  return table;
}

// What the marks mean, and what the ranges of so many cells promise.
std::string PromiseText(const Verdict& verdict, std::size_t cells) {
  std::string text =
      "*: the simplex is faster. =: no difference. [ ]: range of " +
      std::to_string(verdict.groups()) + " groups, ";
  if (verdict.groups() == kGroups) {
    const double pages =
        1.0 / (kFalseWinnerChance * static_cast<double>(cells));
    text +=
        "without the least and the greatest. It covers the median of another "
        "run in 99 % of the cases. If both scans were equally fast, 1 of " +
        Grouped(static_cast<std::size_t>(pages)) +
        " such runs would still mark one of its " + std::to_string(cells) +
        " ratios";
  } else {
    text += "which are too few to trust a winner: leave out --repetitions";
  }
  return text + ". Timed with " + Grouped(verdict.queries()) +
         " different queries. A target is followed by the floats of its "
         "vectors, as in \"AVX2, 8\". A scan keeps the objects that it cannot "
         "reject.";
}

Table TimesTable(const Verdict& verdict) {
  Table times{"verdict: times",
              "ns per object, and the range of the groups",
              {Key("size"), Key("target"), Key("shape"), Key("schedule"),
               Value("time", "ns", 4), Value("over the flat simplex", "", 3)}};
  for (const VerdictWorld& world : verdict.worlds()) {
    for (std::size_t c = 0; c < verdict.columns().size(); ++c) {
      const Timing simplex = world.TimingOf(c, kFlatSimplex);
      for (std::size_t i = 0; i < kContenders.size(); ++i) {
        const Timing ns = world.TimingOf(c, i);
        times.Add({world.name(), verdict.columns()[c].name,
                   NameOf(kContenders[i].shape), kContenders[i].schedule,
                   GroupRange(ns.samples), GroupRange(RatiosOf(ns, simplex))});
      }
    }
  }
  return times;
}

// In one group, with an exact test of that many ns over the objects.
double RatioOf(const GroupTimes& group, const PerShape<double>& survivors,
               double exact) {
  return (group.box + exact * survivors.aabb) /
         (group.simplex + exact * survivors.simplex);
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

double BestTime(std::span<const std::vector<double>> samples) {
  // The median of every second repetition of a contender. A single repetition
  // is both halves.
  const auto half = [](const std::vector<double>& all, std::size_t first) {
    Timing some;
    for (first = std::min(first, all.size() - 1); first < all.size();
         first += 2) {
      some.samples.push_back(all[first]);
    }
    return some.Median();
  };
  double sum = 0.0;
  for (std::size_t chosen_in : {0, 1}) {
    const auto best = std::min_element(
        samples.begin(), samples.end(), [&](const auto& a, const auto& b) {
          return half(a, chosen_in) < half(b, chosen_in);
        });
    sum += half(*best, 1 - chosen_in);
  }
  return sum / 2.0;
}

Cell Marked(const Ratio& box_over_simplex) {
  constexpr Flag kOutcomes[] = {Flag::kWinner, Flag::kNone, Flag::kTie};
  const Winner winner = WinnerOf(box_over_simplex);
  return Cell(box_over_simplex)
      .With(kOutcomes[static_cast<std::size_t>(winner)]);
}

std::string VerdictWorld::name() const {
  return percent == 0.0 ? "file" : PercentText(percent) + " %";
}

PerShape<double> VerdictWorld::MeanSurvivors() const {
  PerShape<double> means;
  const auto groups = static_cast<double>(survivors.size());
  for (const PerShape<double>& each : survivors) {
    for (ShapeKind shape : kShapes) means.Of(shape) += each.Of(shape) / groups;
  }
  return means;
}

Timing VerdictWorld::TimingOf(std::size_t column, std::size_t contender) const {
  Timing timing;
  for (const GroupTimes& group : times[column]) {
    timing.samples.push_back(group.ns[contender]);
  }
  return timing;
}

Ratio VerdictWorld::BoxOverSimplex(std::size_t column, double exact_ns) const {
  const double exact = exact_ns / static_cast<double>(objects);
  std::vector<double> ratios;
  for (std::size_t g = 0; g < survivors.size(); ++g) {
    ratios.push_back(RatioOf(times[column][g], survivors[g], exact));
  }
  return GroupRange(ratios);
}

std::string SimplexText(const Crossings& crossings,
                        std::span<const double> sizes) {
  const Ratio& to = crossings.to;
  // A range that ends below all sizes is none.
  if (to.median == kInfinity || crossings.from.low == kInfinity) {
    return FromText(crossings.from, sizes);
  }
  return SizeText(crossings.from, sizes) + kOfSide + ", up to " +
         SizeText(to, sizes);
}

std::string BoxAgainText(const Crossings& crossings,
                         std::span<const double> sizes) {
  const bool is_always =
      crossings.from.low == kInfinity || crossings.to.high == 0.0;
  return FromText(is_always ? Ratio{} : crossings.to, sizes);
}

std::string RatioText(const Ratio& ratio) {
  const Winner winner = WinnerOf(ratio);
  return Fixed(ratio.median, 2) + " [" + Fixed(ratio.low, 2) + ", " +
         Fixed(ratio.high, 2) + "]: " +
         (winner == Winner::kNone
              ? std::string("no difference")
              : "the " + std::string(NameOf(winner)) + " is faster");
}

// What is measured at one size, for one group.
struct Verdict::Place {
  std::unique_ptr<WorkingSet> set;
  PerShape<double> survivors;
  std::map<std::size_t, GroupTimes> times;  // of each column that was timed
};

Verdict::Verdict(Run& run)
    : sizes_(kPercents.begin(), kPercents.end()), effort_(run.effort) {
  // The narrowest first.
  for (std::size_t t = run.targets.size(); t-- > 0;) {
    const Target target = run.targets[t];
    const std::size_t lanes = target.one_query_lanes();
    columns_.push_back(
        {NameOf(target) + (lanes == 1 ? "" : ", " + std::to_string(lanes)),
         target});
    if (target == run.best()) best_column_ = columns_.size() - 1;
  }
  effort_.repetitions = std::min(kRepetitions, run.RepetitionsOr(kRepetitions));
  effort_.seconds_per_repetition /= 6.0;
  size_ = WorkingSetSizes(run.machine)[1];
  if (run.input() != nullptr) sizes_ = {0.0};
  for (double percent : sizes_) {
    worlds_.push_back({.percent = percent, .objects = size_.objects});
    worlds_.back().times.resize(columns_.size());
  }
  for (Spans& spans : spans_) spans.resize(columns_.size());
}

// Queries go on where the group before has ended: those of a scene are drawn
// anew, like its objects.
Verdict::Place Verdict::MakePlace(Run& run, double percent) const {
  const Workload* input = run.input();
  const std::size_t all = input != nullptr ? input->timed_queries.size()
                          : run.options.queries != 0 ? run.options.queries
                                                     : kTimedQueries;
  const std::size_t count =
      (all + run.VerdictGroups() - 1) / run.VerdictGroups();
  Place place;
  if (input != nullptr) {
    std::vector<Aabo3> queries;
    for (std::size_t q = 0; q < count; ++q) {
      queries.push_back(input->timed_queries[(groups_ * count + q) % all]);
    }
    place.set =
        std::make_unique<WorkingSet>(input->objects, std::move(queries), size_);
  } else {
    // All sizes of a group have the same seed, so that only the size differs.
    place.set = std::make_unique<WorkingSet>(
        SceneOfSize(percent / 100.0, size_.objects,
                    run.options.seed + 1'000'003 * groups_, count),
        size_);
  }
  for (const Aabo3& query : place.set->queries()) {
    AddSurvivors(place.set->view(), query, place.survivors);
  }
  for (ShapeKind shape : kShapes) {
    place.survivors.Of(shape) /=
        static_cast<double>(place.set->queries().size());
  }
  return place;
}

GroupTimes Verdict::TimePlace(Run& run, Place& place, std::size_t column,
                              const Effort& effort) const {
  Contest contest(run, "verdict");
  const auto& [name, target] = columns_[column];
  for (const auto& [shape, schedule, how] : kContenders) {
    Case c = place.set->LibraryCase(shape, {.schedule = how, .target = target});
    // Other groups differ in their places in memory alone.
    if (groups_ != 0) c.check = nullptr;
    contest.Add({name, NameOf(shape), schedule}, std::move(c));
  }
  contest.Time(effort);
  GroupTimes times;
  std::vector<std::vector<double>> samples;
  for (std::size_t c = 0; c < contest.size(); ++c) {
    times.ns.push_back(contest.timing(c).Median());
    samples.push_back(contest.timing(c).samples);
  }
  const auto half = std::span(samples).size() / 2;
  times.simplex = BestTime(std::span(samples).first(half));
  times.box = BestTime(std::span(samples).last(half));
  return times;
}

void Verdict::FindSpans(Run& run, std::map<double, Place>& places) {
  const auto find = [&](std::size_t c, double exact_ns) {
    return FindSpan(sizes_, [&](double percent) {
      Place& place = places[percent];
      if (place.set == nullptr) place = MakePlace(run, percent);
      if (!place.times.contains(c)) {
        place.times[c] = TimePlace(run, place, c, effort_);
      }
      return RatioOf(place.times[c], place.survivors,
                     exact_ns / static_cast<double>(size_.objects));
    });
  };
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    spans_[0][c].push_back(find(c, 0.0));
    // The lead has one line of exact tests.
    if (c != best_column_) continue;
    spans_[1][c].push_back(find(c, run.TheExactTest().ns));
  }
}

void Verdict::AddGroup(Run& run) {
  std::map<double, Place> places;
  Effort complete = effort_;
  complete.is_complete = true;
  for (VerdictWorld& world : worlds_) {
    Place& place = places[world.percent] = MakePlace(run, world.percent);
    world.survivors.push_back(place.survivors);
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      place.times[c] = TimePlace(run, place, c, complete);
      world.times[c].push_back(place.times[c]);
    }
  }
  queries_ += places.begin()->second.set->queries().size();
  // A file with fewer of them is queried with some again.
  if (run.input() != nullptr) {
    queries_ = std::min(queries_, run.input()->timed_queries.size());
  }
  if (!is_of_file()) FindSpans(run, places);
  ++groups_;
  for (double size : sizes_) sets_.push_back(std::move(places.at(size).set));
}

Crossings Verdict::CrossingsOf(std::size_t column, bool with_exact) const {
  std::vector<double> from;
  std::vector<double> to;
  for (const SizeSpan& span : spans_[with_exact ? 1 : 0][column]) {
    from.push_back(span.from);
    to.push_back(span.to);
  }
  return {GroupRange(from), GroupRange(to)};
}

Tables RunVerdict(Run& run) {
  if (run.machine.is_emulated) {
    return {{.name = "verdict",
             .title = "simplex or box",
             .notes = {"Not measured: the CPU is emulated, and its times mean "
                       "nothing."}}};
  }
  const Verdict& verdict = run.TheVerdict();
  const ExactTest exact = run.TheExactTest();
  const std::size_t cells = verdict.worlds().size() * verdict.columns().size();
  Tables tables = {TableOf(run, "verdict",
                           "time of the best float box scan / time of the best "
                           "simplex scan, one query, L2",
                           0.0)};
  tables[0].lead = LeadOf(verdict, exact.ns);
  tables[0].notes.push_back(
      PromiseText(verdict, run.is_page() ? cells : 2 * cells));
  if (run.is_page()) return tables;
  tables.push_back(TableOf(run, "verdict: with exact tests",
                           "the same with an exact test of " +
                               Fixed(exact.ns, 0) + " ns (" + exact.name +
                               ") of each kept object",
                           exact.ns));
  tables.push_back(TimesTable(verdict));
  return tables;
}

}  // namespace halfspace::bench
