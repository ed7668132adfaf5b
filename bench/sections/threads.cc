// Scans that threads share, against one thread.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/measure/team.h"
#include "bench/sections/run.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

// A thread that had less of a CPU shared it with other programs.
constexpr double kLeastShare = 0.9;
// Long enough that a thread which starts late does not count.
constexpr double kSeconds = 0.02;

// What some threads share: each takes a range of the objects.
struct Work {
  std::string name;
  std::size_t objects;
  double pairs;
  std::span<std::uint64_t> masks;  // that run() writes
  std::function<void(const Range&)> run;
};

// Part `i` of `parts`, in whole words.
Range PartOf(std::size_t objects, std::size_t i, std::size_t parts) {
  const std::size_t words = MaskWords(objects);
  return {words * i / parts * 64,
          std::min(objects, words * (i + 1) / parts * 64)};
}

// Real time: the CPU time of a thread alone does not see that it waits for
// memory that the others take. Runs in which another program took a CPU are
// left out.
void AddRows(Run& run, const Work& work, const std::vector<std::size_t>& counts,
             Table& table) {
  constexpr std::size_t kFewest = 3;
  constexpr double kWidest = 2.0;  // a range as wide answers nothing
  work.run({0, work.objects});
  const std::vector<std::uint64_t> expected(work.masks.begin(),
                                            work.masks.end());
  const double once = SecondsOf([&] { work.run({0, work.objects}); });
  const auto rounds =
      static_cast<std::size_t>(std::clamp(kSeconds / once, 1.0, 1e6));
  std::vector<std::vector<double>> ns(counts.size());
  const std::size_t tries = std::max<std::size_t>(10, run.effort.repetitions);
  for (std::size_t t = 0; t < tries * counts.size(); ++t) {
    const std::size_t c = t % counts.size();
    std::fill(work.masks.begin(), work.masks.end(), 0x5555555555555555);
    const TeamTime time = RunTeam(counts[c], [&](std::size_t i) {
      const Range part = PartOf(work.objects, i, counts[c]);
      for (std::size_t r = 0; r < rounds; ++r) work.run(part);
    });
    if (!std::equal(expected.begin(), expected.end(), work.masks.begin())) {
      throw WrongAnswer("threads/" + work.name +
                        ": the masks are not those of one thread");
    }
    if (time.cpu_share < kLeastShare) continue;
    ns[c].push_back(1e9 * time.seconds /
                    (work.pairs * static_cast<double>(rounds)));
  }
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const Ratio one = RangeOf(ns[0]);
    const Ratio all = RangeOf(ns[c]);
    const Ratio times{one.median / all.median, one.low / all.high,
                      one.high / all.low};
    const bool is_timed = std::min(ns[0].size(), ns[c].size()) >= kFewest &&
                          times.high < kWidest * times.low;
    table.Add({work.name, counts[c], is_timed ? Cell(all.median) : Cell(),
               is_timed ? Cell(times) : Cell()});
    if (!is_timed && counts[c] != 1) {
      table.notes.push_back(std::to_string(counts[c]) + " threads, " +
                            work.name +
                            ": not measurable now, other programs take too "
                            "much of the CPUs.");
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
  const Target target = run.best();
  const Workload& workload = run.Measured();
  constexpr std::size_t kObjects = std::size_t{1} << 16;
  constexpr std::size_t kQueries = 32;
  const AaboWorld3 cached = ResizedTo(workload.objects, kObjects);
  std::vector<Aabo3> some;
  for (std::size_t i = 0; i < kQueries; ++i) {
    some.push_back(workload.queries[i % workload.queries.size()]);
  }
  const ShapeQueries queries(some);
  std::vector<std::uint64_t> masks(kQueries * MaskWords(kObjects));
  try {
    AddRows(run,
            {"many queries, cache", kObjects,
             static_cast<double>(kObjects * kQueries), masks,
             [&](const Range& range) {
               SurvivorMasks(cached.view().simplex(), queries.simplices(),
                             std::span(masks).subspan(range.begin / 64),
                             {.target = target, .range = range},
                             MaskWords(kObjects));
             }},
            counts, table);
    for (WorkingSet* set : run.Sets({"memory"})) {
      AddRows(run,
              {"one query, " + set->name(), set->objects(),
               static_cast<double>(set->objects()), set->mask(),
               [&](const Range& range) {
                 SurvivorMask(set->view().simplex(), queries.simplices()[0],
                              std::span(set->mask()).subspan(range.begin / 64),
                              {.target = target, .range = range});
               }},
              counts, table);
    }
  } catch (const std::system_error& error) {
    table.notes.push_back(std::string("No thread can be started: ") +
                          error.what() + ".");
  }
  run.threads = table;
  // The page has the answers alone.
  if (run.is_page()) return {};
  return {table};
}

}  // namespace halfspace::bench
