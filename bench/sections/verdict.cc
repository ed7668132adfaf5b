#include "bench/sections/verdict.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
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

// Two digits of a percentage: "0.84", "3.4", "12".
std::string PercentText(double percent) {
  const int digits = percent < 0.995 ? 2 : percent < 9.95 ? 1 : 0;
  std::string text = Fixed(percent, digits);
  // Whole sizes of rows as they are written there: "0.1", "3".
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
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
  std::vector<double> sizes;
  for (const VerdictWorld& world : verdict.worlds()) {
    sizes.push_back(world.percent);
  }
  // "  AVX2, 8       " and what is measured of it.
  const auto line = [&](std::size_t c, bool is_exact) {
    constexpr std::size_t kWidth = 16;
    std::string name = "  " + verdict.columns()[c].name + " ";
    name.resize(std::max(kWidth, name.size()), ' ');
    if (verdict.is_of_file()) {
      return name + RatioText(verdict.worlds()[0].BoxOverSimplex(
                        c, is_exact ? exact_ns : 0.0));
    }
    const Crossings crossings = verdict.CrossingsOf(c, is_exact);
    return name + (is_exact ? BoxAgainText(crossings, sizes)
                            : SimplexText(crossings, sizes));
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
      "With an exact test of " + Fixed(exact_ns, exact_ns < 9.5 ? 1 : 0) +
      " ns for each survivor" +
      (verdict.is_of_file() ? ":" : ", the box is faster again from"));
  lines.push_back(line(verdict.best_column(), true));
  return lines;
}

// The ratios of each world and column.
Table TableOf(const Verdict& verdict, std::string name, std::string title,
              double exact_ns) {
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
    const std::size_t own = verdict.objects_of_file();
    const std::size_t all = verdict.worlds()[0].objects;
    if (own < all) {
      table.notes.push_back("The file has " + Grouped(own) +
                            " objects. They are repeated up to " +
                            Grouped(all) + ", which fill half of L2.");
    }
    return table;
  }
  table.notes.push_back("size: an object's side over the world's.");
  Chart chart{"size", {}, "", true, true};
  for (std::size_t c = 0; c < verdict.columns().size(); ++c) {
    chart.y.push_back(verdict.columns()[c].name);
    // Unless it lies beyond the sizes that were measured.
    const double from = verdict.CrossingsOf(c, false).from.median;
    if (exact_ns == 0.0 && from > 0.0 && std::isfinite(from)) {
      chart.marks.push_back({chart.y.back(), from});
    }
  }
  table.chart = std::move(chart);
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
        "run in 99 % of the cases. If nothing differed, one of " +
        Grouped(static_cast<std::size_t>(pages)) + " reports of " +
        std::to_string(cells) + " ratios would name a winner";
  } else {
    text += "which are too few to trust a winner: leave out --repetitions";
  }
  return text + ". Timed with " + Grouped(verdict.queries()) +
         " different queries.";
}

Table TimesTable(const Verdict& verdict) {
  Table times{"verdict: times",
              "ns per object, and the range of the groups",
              {Key("size"), Key("target"), Key("shape"), Key("schedule"),
               Value("time", "ns", 4), Value("over the flat simplex", "", 3)}};
  for (const VerdictWorld& world : verdict.worlds()) {
    for (std::size_t c = 0; c < verdict.columns().size(); ++c) {
      for (std::size_t i = 0; i < kContenders.size(); ++i) {
        const auto ns = [i](const GroupTimes& group) { return group.ns[i]; };
        const auto over_simplex = [i](const GroupTimes& group) {
          return group.ns[i] / group.ns[kFlatSimplex];
        };
        times.Add({world.name(), verdict.columns()[c].name,
                   NameOf(kContenders[i].shape), kContenders[i].schedule,
                   GroupRange(world.OfGroups(c, ns)),
                   GroupRange(world.OfGroups(c, over_simplex))});
      }
    }
  }
  return times;
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
  // The median of every second repetition of a contender.
  const auto half = [](const std::vector<double>& all, std::size_t first) {
    std::vector<double> some;
    // A single repetition is both halves.
    for (std::size_t i = std::min(first, all.size() - 1); i < all.size();
         i += 2) {
      some.push_back(all[i]);
    }
    return RangeOf(some).median;
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
  const Winner winner = WinnerOf(box_over_simplex);
  return Cell(box_over_simplex)
      .With(winner == Winner::kSimplex ? Flag::kWinner
            : winner == Winner::kNone  ? Flag::kTie
                                       : Flag::kNone);
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

Ratio VerdictWorld::BoxOverSimplex(std::size_t column, double exact_ns) const {
  const double exact = exact_ns / static_cast<double>(objects);
  std::vector<double> ratios;
  for (std::size_t g = 0; g < survivors.size(); ++g) {
    const GroupTimes& group = times[column][g];
    ratios.push_back((group.box + exact * survivors[g].aabb) /
                     (group.simplex + exact * survivors[g].simplex));
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

Verdict::Verdict(Run& run) : best_target_(run.best()), effort_(run.effort) {
  // The narrowest first.
  for (std::size_t t = run.targets.size(); t-- > 0;) {
    const Target target = run.targets[t];
    const std::size_t lanes = LoopsFor(target).one_query_lanes();
    columns_.push_back(
        {NameOf(target) + (lanes == 1 ? "" : ", " + std::to_string(lanes)),
         target});
  }
  if (run.options.repetitions == 0) effort_.repetitions = kRepetitions;
  effort_.repetitions = std::min(effort_.repetitions, kRepetitions);
  effort_.seconds_per_repetition /= 6.0;
  size_ = WorkingSetSizes(run.machine)[1];
  if (run.input() != nullptr) objects_of_file_ = run.input()->objects.size();
  std::vector<double> percents(kPercents.begin(), kPercents.end());
  if (run.input() != nullptr) percents = {0.0};
  for (double percent : percents) {
    VerdictWorld world;
    world.percent = percent;
    world.objects = size_.objects;
    world.times.resize(columns_.size());
    worlds_.push_back(std::move(world));
  }
  for (Spans& spans : spans_) spans.resize(columns_.size());
}

Verdict::~Verdict() = default;

// Queries go on where the group before has ended: those of a scene are drawn
// anew, like its objects.
Verdict::Place Verdict::MakePlace(Run& run, double percent) const {
  const std::size_t of_groups = run.VerdictGroups();
  Place place;
  if (percent == 0.0) {
    const std::vector<Aabo3>& all = run.input()->timed_queries;
    const std::size_t count = (all.size() + of_groups - 1) / of_groups;
    std::vector<Aabo3> queries;
    for (std::size_t q = 0; q < count; ++q) {
      queries.push_back(all[(groups_ * count + q) % all.size()]);
    }
    place.set = std::make_unique<WorkingSet>(run.input()->objects,
                                             std::move(queries), size_);
  } else {
    const std::size_t all =
        run.options.queries != 0 ? run.options.queries : kTimedQueries;
    // The same seed at all sizes of a group, so that they differ in nothing
    // else.
    place.set = std::make_unique<WorkingSet>(
        SceneOfSize(percent / 100.0, size_.objects,
                    run.options.seed + 1'000'003 * groups_,
                    (all + of_groups - 1) / of_groups),
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
  std::vector<double> sizes;
  for (const VerdictWorld& world : worlds_) sizes.push_back(world.percent);
  const double exact_ns = run.TheExactTest().ns.median;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const auto find = [&](double ns) {
      return FindSpan(sizes, [&](double percent) {
        auto place = places.find(percent);
        if (place == places.end()) {
          place = places.emplace(percent, MakePlace(run, percent)).first;
        }
        std::map<std::size_t, GroupTimes>& timed = place->second.times;
        if (!timed.contains(c)) {
          timed[c] = TimePlace(run, place->second, c, effort_);
        }
        const auto cost = [&](double scan, double survivors) {
          return scan + ns * survivors / static_cast<double>(size_.objects);
        };
        const PerShape<double>& survivors = place->second.survivors;
        return cost(timed[c].box, survivors.aabb) /
               cost(timed[c].simplex, survivors.simplex);
      });
    };
    spans_[0][c].push_back(find(0.0));
    // The lead has one line of exact tests.
    if (c == best_column()) spans_[1][c].push_back(find(exact_ns));
  }
}

void Verdict::AddGroup(Run& run) {
  std::map<double, Place> places;
  Effort complete = effort_;
  complete.is_complete = true;
  for (VerdictWorld& world : worlds_) {
    Place& place = places.emplace(world.percent, MakePlace(run, world.percent))
                       .first->second;
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
  for (VerdictWorld& world : worlds_) {
    sets_.push_back(std::move(places.at(world.percent).set));
  }
}

std::size_t Verdict::best_column() const {
  std::size_t best = columns_.size() - 1;
  while (best > 0 && columns_[best].target != best_target_) --best;
  return best;
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
    return {{"verdict",
             "simplex or box",
             {},
             {},
             {"Not measured: the CPU is emulated, and its times mean "
              "nothing."}}};
  }
  const Verdict& verdict = run.TheVerdict();
  const ExactTest exact = run.TheExactTest();
  const std::size_t cells = verdict.worlds().size() * verdict.columns().size();
  Tables tables = {TableOf(verdict, "verdict",
                           "time of the best float box scan / time of the best "
                           "simplex scan, one query, L2",
                           0.0)};
  tables[0].lead = LeadOf(verdict, exact.ns.median);
  tables[0].notes.push_back(
      PromiseText(verdict, run.is_page() ? cells : 2 * cells));
  if (run.is_page()) return tables;
  tables.push_back(TableOf(verdict, "verdict: with exact tests",
                           "the same with an exact test of " +
                               Fixed(exact.ns.median, 0) + " ns (" +
                               exact.name + ") of each survivor",
                           exact.ns.median));
  tables.push_back(TimesTable(verdict));
  return tables;
}

}  // namespace halfspace::bench
