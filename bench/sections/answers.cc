// What to use on this machine.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/measure/groups.h"
#include "bench/sections/contest.h"
#include "bench/worlds/workload.h"
#include "halfspace/bvh.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::array<std::size_t, 5> kStructuresObjects = {100, 1000, 10'000,
                                                           100'000, 1'000'000};

// Adds a scan of floats, one of uint8, and a BVH, each of which answers queries
// with lists of survivors. They are timed per query. Returns the survivors of a
// query: the mean of some.
template <typename View>
double AddStructures(Contest& contest, const char* shape, const View& view,
                     std::span<const typename View::Query> queries,
                     Target target, const BuildOptions& build) {
  const auto found = std::make_shared<std::vector<std::uint32_t>>(view.size);
  const auto count_of = [=](std::size_t q) {
    return CountSurvivors(view, queries[q], {.schedule = Schedule::kFlat});
  };
  const auto add = [&](const char* structure, const char* precision,
                       auto world) {
    const auto find = [=](std::size_t q) {
      return Survivors(*world, queries[q], *found, {.target = target});
    };
    Case c = CaseOfQueries(queries.size(), view.size,
                           [find](std::size_t q) { std::ignore = find(q); });
    c.check = CheckOf(std::min<std::size_t>(64, queries.size()),
                      "the survivors are not as many as a flat scan finds",
                      [=](std::size_t q) { return find(q) == count_of(q); });
    contest.Add({shape, structure, precision}, std::move(c));
  };
  add("scan", "floats", std::make_shared<View>(view));
  add("scan", "uint8", std::make_shared<QuantizedWorld<View>>(view));
  add("BVH", "floats", std::make_shared<Bvh<View>>(view, build));
  const std::size_t counted = std::min<std::size_t>(256, queries.size());
  std::size_t sum = 0;
  for (std::size_t q = 0; q < counted; ++q) sum += count_of(q);
  return static_cast<double>(sum) / static_cast<double>(counted);
}

// ---- Which bound, precision and structure.

// One method to answer a query with a list of survivors.
struct Method {
  Row words;    // as AddStructures() has them
  Timing time;  // of a query, with the exact test of survivors

  std::string name() const {
    std::string bvh_or_scan = words[0].text + " " + words[1].text;
    if (words[1].text == "BVH") return bvh_or_scan;
    return bvh_or_scan +
           (words[2].text == "uint8" ? " of a QuantizedWorld" : " of floats");
  }
};
enum Word : std::size_t { kShape, kStructure, kPrecision };

// The fastest first.
std::vector<Method> MeasureMethods(Run& run, const AaboWorld3& world) {
  const ShapeQueries queries(run.Measured().timed_queries);
  Contest contest(run, "answers");
  std::vector<double> survivors;
  for (ShapeKind shape :
       {ShapeKind::kSimplex, ShapeKind::kAabb, ShapeKind::kAabo}) {
    queries.With(shape, world.view(), [&](const auto& view, const auto& some) {
      survivors.push_back(
          AddStructures(contest, NameOf(shape), view, some, run.best(), {}));
    });
  }
  // Enough for a range that another run does not leave.
  contest.Time(run.RepetitionsOr(kGroups));
  std::vector<Method> methods;
  for (std::size_t i = 0; i < contest.size(); ++i) {
    methods.push_back({contest.keys(i), contest.timing(i)});
    for (double& ns : methods.back().time.samples) {
      ns += run.TheExactTest().ns * survivors[i / 3];
    }
  }
  std::stable_sort(methods.begin(), methods.end(),
                   [](const Method& a, const Method& b) {
                     return a.time.Median() < b.time.Median();
                   });
  return methods;
}

// An answer is the better of two, if it is so by more than a world at another
// address differs.
void AddAnswer(Table& table, const std::string& question,
               const std::string& use, const std::string& next,
               const Ratio& times_as_fast) {
  constexpr double kLeast = 1.05;
  if (times_as_fast.low > kLeast) {
    table.Add({question, use, Cell(times_as_fast), next});
  } else {
    table.Add({question, "no difference: " + use + ", " + next,
               Cell(times_as_fast).With(Flag::kTie), Cell()});
  }
}

// The fastest method, and the fastest of those that differ from it in a word.
void AddMethods(Table& table, const char* question,
                const std::vector<Method>& methods, Word word) {
  const Method& best = methods.front();
  const auto other = std::find_if(
      methods.begin(), methods.end(),
      [&](const Method& any) { return any.words[word] != best.words[word]; });
  AddAnswer(table, question, best.name(), other->name(),
            GroupRange(RatiosOf(other->time, best.time)));
}

void AddThreads(const Table& threads, Table& table) {
  for (const Row& row : threads.rows) {
    if (!row[3].value || *row[1].value == 1.0) continue;
    const std::string all =
        std::to_string(static_cast<int>(*row[1].value)) + " threads";
    const auto [low, high] = *row[3].spread;
    const std::string question = "threads: " + row[0].text;
    if (const double times = *row[3].value; times >= 1.0) {
      AddAnswer(table, question, all, "one thread", {times, low, high});
    } else {
      AddAnswer(table, question, "one thread", all,
                {1.0 / times, 1.0 / high, 1.0 / low});
    }
  }
  for (const std::string& note : threads.notes) table.notes.push_back(note);
}

Table AnswersTable(Run& run) {
  Table table{"answers",
              "what to use on this machine",
              {Key("question"), Key("use"), Value("times as fast as"),
               Value("the next best")}};
  constexpr std::size_t kMostObjects = std::size_t{1} << 20;
  const AaboWorld3 world =
      Thinned(run.Measured().objects,
              run.options.is_quick ? kMostObjects / 8 : kMostObjects);
  const std::vector<Method> methods = MeasureMethods(run, world);
  AddMethods(table, "shape", methods, kShape);
  std::vector<Method> scans = methods;
  std::erase_if(scans, [](const Method& any) {
    return any.words[kStructure].text != "scan";
  });
  AddMethods(table, "precision of scans", scans, kPrecision);
  AddMethods(table, "structure", methods, kStructure);
  const ExactTest exact = run.TheExactTest();
  table.notes.push_back(
      "Measured on " + Grouped(world.size()) + " objects of " +
      (run.input() != nullptr
           ? run.input()->name + "."
           : "the scene. They take 2 % of the world's side.") +
      " AABO: an 8-DOP. An exact test of each kept object takes " +
      Fixed(exact.ns, 0) + " ns (" + exact.name +
      "). \"No difference\" is one of less than a twentieth.");
  AddThreads(run.threads, table);
  return table;
}

// ---- Which structure, for how many queries between two changes of the world.

// The number of queries from which on a structure that takes `make` pays;
// infinite if it never does.
double PaysFrom(double make, double query, double other_make,
                double other_query) {
  if (query >= other_query) return kInfinity;
  return std::ceil(std::max(1.0, (make - other_make) / (other_query - query)));
}

// A world of boxes in three structures.
Row StructuresRow(Run& run, std::size_t objects) {
  constexpr double kShare = 0.02;  // of the world's side: the paper's density
  constexpr BuildOptions kFast = {.quality = BuildQuality::kFast};
  const Workload scene =
      SceneOfSize(kShare, objects, run.options.seed, /*queries=*/2000);
  const AabbView3 view = scene.objects.view().aabb();
  std::vector<Aabb3> queries;
  for (const Aabo3& query : scene.queries) queries.push_back(query.aabb());
  enum Job : std::size_t { kScan, kQuantized, kBvh, kEncode, kBuild };
  Contest contest(run, "structures");
  AddStructures(contest, "AABB", view, queries, run.best(), kFast);
  const auto add = [&](const char* name, auto make) {
    Case c;
    c.run = [make] { KeepResult(static_cast<std::uint32_t>(make().size())); };
    contest.Add({name}, std::move(c));
  };
  add("encode", [&] { return QuantizedWorld<AabbView3>(view); });
  add("build", [&] { return Bvh<AabbView3>(view, kFast); });
  contest.Time(run.RepetitionsOr(9));
  std::vector<double> encoding_pays;
  std::vector<double> bvh_pays;
  for (std::size_t r = 0; r < run.RepetitionsOr(9); ++r) {
    const auto of = [&](Job job) { return contest.timing(job).samples[r]; };
    const double encoding =
        PaysFrom(of(kEncode), of(kQuantized), 0.0, of(kScan));
    double tree = PaysFrom(of(kBuild), of(kBvh), 0.0, of(kScan));
    // Where encoding takes longer than the scan, nobody encodes.
    if (encoding < tree) {
      tree = std::max(
          tree, PaysFrom(of(kBuild), of(kBvh), of(kEncode), of(kQuantized)));
    }
    encoding_pays.push_back(encoding);
    bvh_pays.push_back(tree);
  }
  Row row = {objects};
  for (std::size_t i = 0; i < contest.size(); ++i) {
    row.emplace_back(contest.Median(i) / 1e3);
  }
  for (const auto& pays : {encoding_pays, bvh_pays}) {
    const Ratio from = GroupRange(pays);
    row.push_back(std::isfinite(from.median) ? Cell(from) : "never");
  }
  return row;
}

Table StructuresTable(Run& run) {
  Table table{
      "answers: structures",
      "time of a query and of making a structure, and the queries between two "
      "changes of the world from which that pays",
      {Key("objects"), Value("scan", "us"), Value("quantized", "us"),
       Value("BVH", "us"), Value("encode", "us", 0), Value("build", "us", 0),
       Value("quantizing pays from", "", 0), Value("a BVH pays from", "", 0)}};
  table.chart = Chart{
      "objects", {"quantizing pays from", "a BVH pays from"}, "", true, true};
  for (std::size_t objects : kStructuresObjects) {
    if (run.options.objects != 0 && objects > run.options.objects) continue;
    table.Add(StructuresRow(run, objects));
  }
  // The page needs the answers alone.
  if (run.is_page()) {
    table.columns.erase(table.columns.begin() + 4, table.columns.begin() + 6);
    for (Row& row : table.rows) row.erase(row.begin() + 4, row.begin() + 6);
  }
  table.notes = {
      "Boxes that take 2 % of the world's side, a list of the kept objects for "
      "each "
      "query, one thread, the BVH by its fast build. A BVH whose objects move "
      "a little can be refitted instead, in less time: section bvh."};
  return table;
}

}  // namespace

Tables RunAnswers(Run& run) {
  if (run.machine.is_emulated) {
    return {{.name = "answers",
             .title = "what to use on this machine",
             .notes = {"The CPU is emulated: there are no answers."}}};
  }
  return {AnswersTable(run), StructuresTable(run)};
}

}  // namespace halfspace::bench
