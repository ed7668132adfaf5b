// What to use on this machine.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/measure/groups.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"
#include "halfspace/bvh.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

// A case that answers queries with lists of survivors. find(query) returns how
// many there are: as many as in a flat scan of `view`, for some queries.
template <typename View, typename Find>
Case ListCase(std::string name, const View& view,
              const std::vector<typename View::Query>& queries,
              std::size_t per_run, Find find) {
  Case c = InTurn(std::move(name), queries, queries.size(), per_run,
                  [find](const auto& query) { std::ignore = find(query); });
  c.check = [view, &queries, find]() -> std::string {
    for (std::size_t q = 0; q < std::min<std::size_t>(64, queries.size());
         ++q) {
      if (find(queries[q]) !=
          CountSurvivors(view, queries[q], {.schedule = Schedule::kFlat})) {
        return "the survivors are not as many as a flat scan finds";
      }
    }
    return {};
  };
  return c;
}

// Of a scan that takes few, a run has more queries.
std::size_t QueriesInScan(std::size_t objects) {
  return std::clamp<std::size_t>((std::size_t{1} << 16) / objects, 1, 64);
}

// ---- Which bound, precision and structure.

// One way to answer a query with a list of survivors.
struct Way {
  std::string shape;
  std::string structure;  // "scan" or "BVH"
  std::string precision;  // "floats" or "uint8"
  double survivors;       // of a query
  Timing time = {};       // of a query, with the exact test of survivors

  std::string name() const { return shape + " " + structure + " " + precision; }
};

// Every way to query one world with one kind of bound.
template <typename View>
class WaysOf {
 public:
  using Query = typename View::Query;

  WaysOf(ShapeKind shape, const View& view, std::span<const Aabo3> queries,
         const Options& options)
      : shape_(NameOf(shape)),
        view_(view),
        bytes_(view),
        bvh_(view),
        options_(options),
        found_(view.size) {
    for (const Aabo3& query : queries) queries_.push_back(SeenAs<Query>(query));
  }

  void AddTo(std::vector<Way>& ways, std::vector<Case>& cases) {
    constexpr std::size_t kCounted = 256;
    const std::size_t counted = std::min(kCounted, queries_.size());
    double survivors = 0.0;
    for (std::size_t q = 0; q < counted; ++q) {
      survivors += static_cast<double>(CountSurvivors(view_, queries_[q])) /
                   static_cast<double>(counted);
    }
    const auto add = [&](const char* structure, const char* precision,
                         std::size_t per_run, auto find) {
      ways.push_back({shape_, structure, precision, survivors});
      cases.push_back(ListCase("answers/" + ways.back().name(), view_, queries_,
                               per_run, find));
      cases.back().group = "answers";
    };
    const std::size_t in_scan = QueriesInScan(view_.size);
    add("scan", "floats", in_scan, [this](const Query& query) {
      return Survivors(view_, query, found_, options_);
    });
    add("scan", "uint8", in_scan, [this](const Query& query) {
      return Survivors(bytes_, query, found_, options_);
    });
    add("BVH", "floats", 64, [this](const Query& query) {
      return Survivors(bvh_, query, found_, {.target = options_.target});
    });
  }

 private:
  std::string shape_;
  View view_;
  QuantizedWorld<View> bytes_;
  Bvh<View> bvh_;
  Options options_;
  std::vector<Query> queries_;
  std::vector<std::uint32_t> found_;
};

// The fastest first.
std::vector<Way> MeasureWays(Run& run, const AaboWorld3& world) {
  const std::vector<Aabo3>& queries = run.Measured().timed_queries;
  const Options options{.target = run.best()};
  const AaboView3 view = world.view();
  WaysOf<SimplexView3> simplex(ShapeKind::kSimplex, view.simplex(), queries,
                               options);
  WaysOf<AabbView3> aabb(ShapeKind::kAabb, view.aabb(), queries, options);
  WaysOf<AaboView3> aabo(ShapeKind::kAabo, view, queries, options);
  std::vector<Way> ways;
  std::vector<Case> cases;
  simplex.AddTo(ways, cases);
  aabb.AddTo(ways, cases);
  aabo.AddTo(ways, cases);
  // Enough for a range that another run does not leave.
  Effort effort = run.effort;
  if (run.options.repetitions == 0) effort.repetitions = kGroups;
  const std::vector<Timing> timings = run.Time(cases, effort);
  const double exact_ns = run.TheExactTest().ns.median;
  for (std::size_t i = 0; i < ways.size(); ++i) {
    ways[i].time = timings[i];
    for (double& ns : ways[i].time.samples) ns += exact_ns * ways[i].survivors;
  }
  std::sort(ways.begin(), ways.end(), [](const Way& a, const Way& b) {
    return a.time.Median() < b.time.Median();
  });
  return ways;
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

// The best way of all, and the best of those that are_others.
template <typename AreOthers, typename Name>
void AddWays(Table& table, const char* question, const std::vector<Way>& ways,
             AreOthers are_others, Name name) {
  const auto one = std::find_if_not(ways.begin(), ways.end(), are_others);
  const auto other = std::find_if(ways.begin(), ways.end(), are_others);
  if (one == ways.end() || other == ways.end()) return;
  const Way& better = *std::min(one, other);
  const Way& worse = *std::max(one, other);
  std::vector<double> ratios = worse.time.samples;
  for (std::size_t r = 0; r < ratios.size(); ++r) {
    ratios[r] /= better.time.samples[r];
  }
  AddAnswer(table, question, name(better), name(worse), GroupRange(ratios));
}

void AddThreads(const Table& threads, Table& table) {
  for (const Row& row : threads.rows) {
    if (!row[3].value || *row[1].value == 1.0) continue;
    const std::string all =
        std::to_string(static_cast<int>(*row[1].value)) + " threads";
    const Ratio times{*row[3].value, row[3].spread->first,
                      row[3].spread->second};
    const Ratio of_one{1.0 / times.median, 1.0 / times.high, 1.0 / times.low};
    if (times.median >= 1.0) {
      AddAnswer(table, "threads: " + row[0].text, all, "one thread", times);
    } else {
      AddAnswer(table, "threads: " + row[0].text, "one thread", all, of_one);
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
  const AaboWorld3 world = Thinned(
      run.Measured().objects, run.is_quick() ? kMostObjects / 8 : kMostObjects);
  const std::vector<Way> ways = MeasureWays(run, world);
  AddWays(
      table, "shape", ways,
      [&](const Way& way) { return way.shape != ways.front().shape; },
      [](const Way& way) { return way.name(); });
  std::vector<Way> scans = ways;
  std::erase_if(scans, [](const Way& way) { return way.structure == "BVH"; });
  AddWays(
      table, "precision of scans", scans,
      [](const Way& way) { return way.precision == "floats"; },
      [](const Way& way) { return way.precision + " (" + way.shape + ")"; });
  AddWays(
      table, "structure", ways,
      [](const Way& way) { return way.structure == "BVH"; },
      [](const Way& way) {
        return way.structure + " (" + way.shape + " " + way.precision + ")";
      });
  const ExactTest exact = run.TheExactTest();
  table.notes.push_back(
      "Measured on " + Grouped(world.size()) + " objects of " +
      (run.input() != nullptr
           ? run.input()->name + "."
           : "the scene. They take 2 % of the world's side.") +
      " The exact test of a survivor takes " + Fixed(exact.ns.median, 0) +
      " ns (" + exact.name +
      "). \"No difference\" is one of less than a twentieth.");
  if (const Table* threads = run.TableOf("threads")) {
    AddThreads(*threads, table);
  }
  if (!run.machine.HasCache(3)) {
    table.notes.push_back(
        "The system names no third-level cache: the size of \"memory\" is a "
        "guess, of " +
        Mebibytes(WorkingSetSizes(run.machine).back().bytes) +
        " for the simplex.");
  }
  return table;
}

// ---- Which structure, for how many queries between two changes of the world.

// The number of queries from which on a structure that takes `make` pays;
// infinite if it never does.
double PaysFrom(double make, double query, double other_make,
                double other_query) {
  if (query >= other_query) return std::numeric_limits<double>::infinity();
  return std::max(1.0, (make - other_make) / (other_query - query));
}

// The number of queries, or "never".
Cell QueriesCell(const Ratio& queries) {
  if (!std::isfinite(queries.median)) return "never";
  return Ratio{std::ceil(queries.median), std::ceil(queries.low),
               std::ceil(queries.high)};
}

// A world of boxes in three structures.
Row StructuresRow(Run& run, std::size_t objects, const Effort& effort) {
  constexpr double kShare = 0.02;  // of the world's side: the paper's density
  constexpr BuildOptions kFast = {.quality = BuildQuality::kFast};
  const Workload scene =
      SceneOfSize(kShare, objects, run.options.seed, /*queries=*/2000);
  const AabbView3 view = scene.objects.view().aabb();
  const QuantizedWorld<AabbView3> quantized(view);
  const Bvh<AabbView3> bvh(view, kFast);
  const Options options{.target = run.best()};
  std::vector<std::uint32_t> found(objects);
  std::vector<Aabb3> queries;
  for (const Aabo3& query : scene.queries) queries.push_back(query.aabb());

  enum Job : std::size_t { kScan, kQuantized, kBvh, kEncode, kBuild };
  std::vector<Case> cases(5);
  const std::size_t in_scan = QueriesInScan(objects);
  cases[kScan] = ListCase(
      "structures/scan", view, queries, in_scan,
      [&](const Aabb3& box) { return Survivors(view, box, found, options); });
  cases[kQuantized] = ListCase(
      "structures/quantized", view, queries, in_scan, [&](const Aabb3& box) {
        return Survivors(quantized, box, found, options);
      });
  cases[kBvh] =
      ListCase("structures/BVH", view, queries, 64, [&](const Aabb3& box) {
        return Survivors(bvh, box, found, {.target = options.target});
      });
  cases[kEncode].name = "structures/encode";
  cases[kEncode].run = [&] {
    const QuantizedWorld<AabbView3> made(view);
    KeepResult(static_cast<std::uint32_t>(made.size()));
  };
  cases[kBuild].name = "structures/build";
  cases[kBuild].run = [&] {
    const Bvh<AabbView3> made(view, kFast);
    KeepResult(static_cast<std::uint32_t>(made.size()));
  };
  const std::vector<Timing> ns = run.Time(cases, effort);
  std::vector<double> encoding_pays;
  std::vector<double> bvh_pays;
  for (std::size_t r = 0; r < effort.repetitions; ++r) {
    const auto of = [&](Job job) { return ns[job].samples[r]; };
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
  for (const Timing& timing : ns) row.emplace_back(timing.Median() / 1e3);
  row.push_back(QueriesCell(GroupRange(encoding_pays)));
  row.push_back(QueriesCell(GroupRange(bvh_pays)));
  return row;
}

Table StructuresTable(Run& run) {
  Table table{
      "answers: structures",
      "time of a query and of making a structure, and the queries between two "
      "changes of the world from which that pays",
      {Key("objects"), Value("scan", "us"), Value("quantized", "us"),
       Value("BVH", "us"), Value("encode", "us", 0), Value("build", "us", 0),
       Value("encoding pays from", "", 0), Value("a BVH pays from", "", 0)}};
  table.chart = Chart{
      "objects", {"encoding pays from", "a BVH pays from"}, "", true, true};
  Effort effort = run.effort;
  effort.repetitions =
      run.options.repetitions != 0 ? run.options.repetitions : 9;
  for (std::size_t objects : {100, 1000, 10'000, 100'000, 1'000'000}) {
    if (run.options.objects != 0 && objects > run.options.objects) continue;
    table.Add(StructuresRow(run, objects, effort));
  }
  // The page needs the answers alone.
  if (run.is_page()) {
    const auto drop = [](auto& list) {
      list.erase(list.begin() + 4, list.begin() + 6);
    };
    drop(table.columns);
    for (Row& row : table.rows) drop(row);
  }
  table.notes = {
      "Boxes that take 2 % of the world's side, a list of survivors for each "
      "query, one thread, the BVH by its fast build. A BVH whose objects move "
      "a little can be refitted instead, in less time: section bvh."};
  return table;
}

}  // namespace

Tables RunAnswers(Run& run) {
  if (run.machine.is_emulated) {
    return {{"answers",
             "what to use on this machine",
             {},
             {},
             {"The CPU is emulated: there are no answers."}}};
  }
  return {AnswersTable(run), StructuresTable(run)};
}

}  // namespace halfspace::bench
