// What to use on this machine.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/curves.h"
#include "bench/measure/groups.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"
#include "halfspace/bvh.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

// The columns of "sweep: own workload".
enum Column : std::size_t { kShape, kSchedule, kPrecision, kOfBest = 6 };

using IsOneOf = std::function<bool(const Row&)>;

bool IsBvh(const Row& way) { return way[kSchedule].text == "BVH"; }
bool IsQuantized(const Row& way) { return way[kPrecision].text != "floats"; }

// The first one: ways are in the order of their times.
const Row* FastestOf(const Table& ways, const IsOneOf& is_one) {
  for (const Row& way : ways.rows) {
    if (is_one(way)) return &way;
  }
  return nullptr;
}

// A world at another address differs by up to a twentieth.
bool IsAnswer(const Ratio& times_as_fast) {
  constexpr double kLeast = 1.05;
  return times_as_fast.low > kLeast;
}

// The better of two ways, of their times over the best way's.
void Add(Table& table, const char* question, const Row* one, const Row* other,
         const std::function<std::string(const Row&)>& name) {
  if (one == nullptr || other == nullptr) return;
  if (*one->at(kOfBest).value > *other->at(kOfBest).value) {
    std::swap(one, other);
  }
  const auto spread = [](const Row* way) {
    const Cell& cell = way->at(kOfBest);
    return cell.spread.value_or(std::pair(*cell.value, *cell.value));
  };
  const Ratio times{*other->at(kOfBest).value / *one->at(kOfBest).value,
                    spread(other).first / spread(one).second,
                    spread(other).second / spread(one).first};
  const bool is_tie = !IsAnswer(times);
  table.Add({question,
             is_tie ? "no difference: " + name(*one) + ", " + name(*other)
                    : name(*one),
             Cell(times).With(is_tie ? Flag::kTie : Flag::kNone),
             is_tie ? Cell() : Cell(name(*other))});
}

std::string WhatIsMeasured(Run& run, const Table& ways) {
  const ExactTest exact = run.TheExactTest();
  return "Measured on " + ways.notes.front() +
         (run.input() != nullptr ? "" : " They take 2 % of its side.") +
         " The exact test of a survivor takes " + Fixed(exact.ns.median, 0) +
         " ns (" + exact.name +
         "). \"No difference\" is one of less than a twentieth.";
}

void AddThreads(const Table& threads, Table& table) {
  for (const Row& row : threads.rows) {
    if (!row[3].value || *row[1].value == 1.0) continue;
    const std::string question = "threads: " + row[0].text;
    const std::string all =
        std::to_string(static_cast<int>(*row[1].value)) + " threads";
    const Ratio times{*row[3].value, row[3].spread->first,
                      row[3].spread->second};
    const Ratio of_one{1.0 / times.median, 1.0 / times.high, 1.0 / times.low};
    if (IsAnswer(times)) {
      table.Add({question, all, Cell(times), "one thread"});
    } else if (IsAnswer(of_one)) {
      table.Add({question, "one thread", Cell(of_one), all});
    } else {
      table.Add({question, "no difference: one thread, " + all,
                 Cell(times).With(Flag::kTie), Cell()});
    }
  }
  for (const std::string& note : threads.notes) table.notes.push_back(note);
}

// Which structure, for how many queries between two changes of the world.
constexpr std::array<std::size_t, 5> kSizes = {100, 1000, 10'000, 100'000,
                                               1'000'000};
constexpr double kShare = 0.02;  // of the world's side: the paper's density
constexpr std::size_t kQueries = 2000;
constexpr std::size_t kCheckedQueries = 64;

// A world of boxes in three structures.
class Structures {
 public:
  Structures(std::size_t objects, std::uint64_t seed, Target target)
      : scene_(SceneOfSize(kShare, objects, seed, kQueries)),
        view_(scene_.objects.view().aabb()),
        quantized_(view_),
        bvh_(view_, kFast),
        options_({.target = target}),
        found_(objects) {
    for (const Aabo3& query : scene_.queries) queries_.push_back(query.aabb());
  }

  // The query in each structure, and the two builds.
  enum Job : std::size_t { kScan, kQuantized, kBvh, kEncode, kBuild };
  std::vector<Case> Cases() {
    std::vector<Case> cases;
    const auto query = [&](const char* name, std::size_t per_run, auto find) {
      cases.push_back(InTurn(name, queries_, queries_.size(), per_run,
                             [find](const Aabb3& box) { (void)find(box); }));
      cases.back().check = [this, find]() -> std::string {
        for (std::size_t q = 0; q < kCheckedQueries; ++q) {
          const Options flat{.schedule = Schedule::kFlat};
          if (find(queries_[q]) != CountSurvivors(view_, queries_[q], flat)) {
            return "the survivors are not as many as a flat scan finds";
          }
        }
        return {};
      };
    };
    const std::size_t in_a_scan = std::clamp<std::size_t>(
        (std::size_t{1} << 16) / view_.size, 1, kCheckedQueries);
    query("structures/scan", in_a_scan, [this](const Aabb3& box) {
      return Survivors(view_, box, found_, options_);
    });
    query("structures/quantized", in_a_scan, [this](const Aabb3& box) {
      return Survivors(quantized_, box, found_, options_);
    });
    query("structures/BVH", kCheckedQueries, [this](const Aabb3& box) {
      return Survivors(bvh_, box, found_, {.target = options_.target});
    });
    cases.resize(5);
    cases[kEncode].name = "structures/encode";
    cases[kEncode].run = [this] {
      const Quantized made(view_);
      KeepResult(static_cast<std::uint32_t>(made.size()));
    };
    cases[kBuild].name = "structures/build";
    cases[kBuild].run = [this] {
      const Tree made(view_, kFast);
      KeepResult(static_cast<std::uint32_t>(made.size()));
    };
    return cases;
  }

 private:
  using Quantized = QuantizedWorld<AabbView3>;
  using Tree = Bvh<AabbView3>;
  static constexpr BuildOptions kFast = {.quality = BuildQuality::kFast};

  Workload scene_;
  AabbView3 view_;
  Quantized quantized_;
  Tree bvh_;
  Options options_;
  std::vector<Aabb3> queries_;
  std::vector<std::uint32_t> found_;
};

// The number of queries, or "never".
Cell QueriesCell(const Ratio& queries) {
  if (!std::isfinite(queries.median)) return "never";
  return Ratio{std::ceil(queries.median), std::ceil(queries.low),
               std::ceil(queries.high)};
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
  for (std::size_t objects : kSizes) {
    if (run.options.objects != 0 && objects > run.options.objects) continue;
    Structures structures(objects, run.options.seed, run.best());
    const std::vector<Timing> ns = run.Time(structures.Cases(), effort);
    std::vector<double> encoding;
    std::vector<double> bvh;
    for (std::size_t r = 0; r < effort.repetitions; ++r) {
      const auto of = [&](Structures::Job job) { return ns[job].samples[r]; };
      const StructureCost scan{0.0, of(Structures::kScan)};
      const StructureCost quantized{of(Structures::kEncode),
                                    of(Structures::kQuantized)};
      const StructureCost tree{of(Structures::kBuild), of(Structures::kBvh)};
      encoding.push_back(PaysFrom(quantized, scan));
      bvh.push_back(PaysFrom(tree, scan));
      // Where encoding takes longer than the scan, nobody encodes.
      if (encoding.back() < bvh.back()) {
        bvh.back() = std::max(bvh.back(), PaysFrom(tree, quantized));
      }
    }
    const auto us = [&](Structures::Job job) { return ns[job].Median() / 1e3; };
    table.Add({objects, us(Structures::kScan), us(Structures::kQuantized),
               us(Structures::kBvh), us(Structures::kEncode),
               us(Structures::kBuild), QueriesCell(GroupRange(encoding)),
               QueriesCell(GroupRange(bvh))});
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
  Table table{"answers",
              "what to use on this machine",
              {Key("question"), Key("use"), Value("times as fast as"),
               Value("the next best")}};
  if (run.machine.is_emulated) {
    table.notes = {"The CPU is emulated: there are no answers."};
    return {table};
  }
  if (const Table* ways = run.TableOf("sweep: own workload")) {
    const Row& best = ways->rows.front();
    Add(table, "shape", &best,
        FastestOf(*ways,
                  [&](const Row& way) {
                    return way[kShape].text != best[kShape].text;
                  }),
        [](const Row& way) {
          return way[kShape].text + " " + way[kSchedule].text + " " +
                 way[kPrecision].text;
        });
    const Row* scan = FastestOf(
        *ways, [](const Row& w) { return !IsBvh(w) && !IsQuantized(w); });
    Add(table, "precision of scans", FastestOf(*ways, IsQuantized), scan,
        [](const Row& way) {
          return way[kPrecision].text + " (" + way[kShape].text + ")";
        });
    Add(table, "structure", FastestOf(*ways, IsBvh),
        FastestOf(*ways, [](const Row& way) { return !IsBvh(way); }),
        [](const Row& way) {
          return (IsBvh(way) ? "BVH (" : "scan (") + way[kShape].text + " " +
                 way[kPrecision].text + ")";
        });
    table.notes.push_back(WhatIsMeasured(run, *ways));
  } else {
    table.notes.push_back(
        "Shape, precision and structure: run the section sweep too.");
  }
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
  return {table, StructuresTable(run)};
}

}  // namespace halfspace::bench
