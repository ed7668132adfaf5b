// What to use on this machine.
#include <cstddef>
#include <functional>
#include <string>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/sections/structures.h"

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
