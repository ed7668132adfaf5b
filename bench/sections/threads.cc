// Scans that threads share, against one thread.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/run.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

// Long enough that a thread which starts late does not count.
constexpr double kSeconds = 0.02;

// A scan that threads share: each takes a range of the objects, in whole words.
// Real time: the CPU time of a thread alone does not see that it waits for
// memory that the others take. Runs in which another program took a CPU are
// left out.
void AddRows(Run& run, const std::string& name, const SimplexView3& view,
             std::span<const DownSimplex3> queries,
             const std::vector<std::size_t>& counts, Table& table) {
  constexpr std::size_t kFewest = 3;
  constexpr double kWidest = 2.0;  // a range as wide answers nothing
  const Target target = run.best();
  const std::size_t words = MaskWords(view.size);
  std::vector<std::uint64_t> masks(queries.size() * words);
  const auto scan = [&](const Range& range) {
    const Options options{.target = target, .range = range};
    const auto to = std::span(masks).subspan(range.begin / 64);
    if (queries.size() == 1) {
      SurvivorMask(view, queries[0], to, options);
    } else {
      SurvivorMasks(view, queries, to, options, words);
    }
  };
  scan({0, view.size});
  const std::vector<std::uint64_t> expected = masks;
  const double once = SecondsOf([&] { scan({0, view.size}); });
  const auto rounds =
      static_cast<std::size_t>(std::clamp(kSeconds / once, 1.0, 1e6));
  std::vector<std::vector<double>> ns(counts.size());
  const std::size_t tries = std::max<std::size_t>(10, run.effort.repetitions);
  for (std::size_t t = 0; t < tries * counts.size(); ++t) {
    const std::size_t c = t % counts.size();
    std::fill(masks.begin(), masks.end(), 0x5555555555555555);
    const TeamTime time = RunTeam(counts[c], [&](std::size_t i) {
      const Range part = {
          words * i / counts[c] * 64,
          std::min(view.size, words * (i + 1) / counts[c] * 64)};
      for (std::size_t r = 0; r < rounds; ++r) scan(part);
    });
    if (masks != expected) {
      throw WrongAnswer("threads/" + name +
                        ": the masks are not those of one thread");
    }
    if (time.cpu_share < kWholeCpu) continue;
    ns[c].push_back(1e9 * time.seconds /
                    static_cast<double>(queries.size() * view.size * rounds));
  }
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const Ratio one = RangeOf(ns[0]);
    const Ratio all = RangeOf(ns[c]);
    const Ratio times{one.median / all.median, one.low / all.high,
                      one.high / all.low};
    const bool is_timed = std::min(ns[0].size(), ns[c].size()) >= kFewest &&
                          times.high < kWidest * times.low;
    table.Add({name, counts[c], is_timed ? Cell(all.median) : Cell(),
               is_timed ? Cell(times) : Cell()});
    if (!is_timed && counts[c] != 1) {
      table.notes.push_back(std::to_string(counts[c]) + " threads, " + name +
                            ": not measured. Other programs took the CPUs, "
                            "or the times differed by a factor of 2.");
    }
  }
}

}  // namespace

Tables RunThreads(Run& run) {
  Table table{"threads",
              "scans that threads share, real time",
              {Key("work"), Key("threads"), Value("ns/pair", "", 4),
               Value("times as fast as one")}};
  const int cpus = UsableCpus();
  if (cpus < 2) {
    table.notes = {"Not measured: this run may use one CPU."};
    return {table};
  }
  // 1, 2, 4, ... and all CPUs.
  std::vector<std::size_t> counts;
  for (std::size_t n = 1; n < static_cast<std::size_t>(cpus); n *= 2) {
    counts.push_back(n);
  }
  counts.push_back(static_cast<std::size_t>(cpus));
  constexpr std::size_t kObjects = std::size_t{1} << 16;
  constexpr std::size_t kQueries = 32;
  const AaboWorld3 cached = ResizedTo(run.Measured().objects, kObjects);
  const std::vector<Aabo3>& all = run.Measured().queries;
  std::vector<DownSimplex3> queries;
  for (std::size_t i = 0; i < kQueries; ++i) {
    queries.push_back(all[i % all.size()].down());
  }
  try {
    AddRows(run, "many queries, cache", cached.view().simplex(), queries,
            counts, table);
    for (WorkingSet* set : run.Sets({"memory"})) {
      AddRows(run, "one query, " + set->name(), set->view().simplex(),
              std::span(queries).first(1), counts, table);
    }
  } catch (const std::system_error& error) {
    table.notes.push_back(std::string("No thread can be started: ") +
                          error.what() + ".");
  }
  run.threads = table;
  // The page has the answers alone.
  return run.is_page() ? Tables() : Tables{table};
}

}  // namespace halfspace::bench
