#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "bench/base/shape_queries.h"
#include "bench/measure/two_threads.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "halfspace/reject.h"
#include "halfspace/reject_many.h"

namespace halfspace::bench {
namespace {

// What some threads share: each takes a range of the objects.
struct Work {
  std::string name;
  std::size_t objects;
  double pairs;
  std::span<std::uint64_t> masks;  // that run() writes
  std::function<void(const Range&)> run;
};

// 1, 2, 4, ... and all CPUs.
std::vector<std::size_t> ThreadCounts(std::size_t cpus) {
  std::vector<std::size_t> counts;
  for (std::size_t n = 1; n < cpus; n *= 2) counts.push_back(n);
  counts.push_back(cpus);
  return counts;
}

// Part `i` of `parts`, in whole words.
Range PartOf(std::size_t objects, std::size_t i, std::size_t parts) {
  const std::size_t words = MaskWords(objects);
  return {words * i / parts * 64,
          std::min(objects, words * (i + 1) / parts * 64)};
}

// A team of threads, of which the caller is one.
class Team {
 public:
  Team(const Work& work, std::size_t threads) : work_(work), threads_(threads) {
    for (std::size_t i = 1; i < threads; ++i) {
      others_.push_back(std::make_unique<OtherThread>(
          [this, i] { work_.run(PartOf(work_.objects, i, threads_)); }));
    }
  }

  void Run() {
    for (const auto& other : others_) other->Start();
    work_.run(PartOf(work_.objects, 0, threads_));
    for (const auto& other : others_) other->Wait();
  }

 private:
  const Work& work_;
  std::size_t threads_;
  std::vector<std::unique_ptr<OtherThread>> others_;
};

// Real time: that of a thread alone does not see that it waits for memory that
// the others take. Of the runs of a team the fastest counts, as other programs
// disturb it.
void RunWork(const Work& work, const std::vector<std::size_t>& counts,
             const Context& context, ThreadsResult& result) {
  constexpr std::size_t kRuns = 20;
  work.run({0, work.objects});
  const std::vector<std::uint64_t> expected(work.masks.begin(),
                                            work.masks.end());
  Timings timings;
  for (std::size_t threads : counts) {
    timings.push_back({"threads/" + work.name + "/" + std::to_string(threads),
                       {},
                       work.pairs,
                       1});
  }
  for (std::size_t round = 0; round < context.effort.repetitions; ++round) {
    for (std::size_t c = 0; c < counts.size(); ++c) {
      Team team(work, counts[c]);
      std::fill(work.masks.begin(), work.masks.end(), 0x5555555555555555);
      double fastest = SecondsOf([&] { team.Run(); });
      if (!std::equal(expected.begin(), expected.end(), work.masks.begin())) {
        throw WrongAnswer(timings[c].name +
                          ": the masks are not those of one thread");
      }
      for (std::size_t run = 1; run < kRuns; ++run) {
        fastest = std::min(fastest, SecondsOf([&] { team.Run(); }));
      }
      timings[c].samples.push_back(1e9 * fastest / work.pairs);
    }
  }
  for (std::size_t c = 0; c < counts.size(); ++c) {
    result.rows.push_back({work.name, counts[c], timings[c].Median(),
                           RatioOf(timings[0], timings[c])});
  }
  context.timings.insert(context.timings.end(), timings.begin(), timings.end());
}

}  // namespace

ThreadsResult RunThreads(const Workload& workload,
                         const std::vector<WorkingSet*>& memory,
                         const Context& context) {
  ThreadsResult result;
  const int cpus = UsableCpus();
  if (cpus < 2) {
    result.not_reached.push_back("threads: this run may use one CPU");
    return result;
  }
  const std::vector<std::size_t> counts =
      ThreadCounts(static_cast<std::size_t>(cpus));
  const Target target = context.targets.front();
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
    RunWork({"many queries, cache", kObjects,
             static_cast<double>(kObjects * kQueries), masks,
             [&](const Range& range) {
               SurvivorMasks(cached.view().simplex(), queries.simplices(),
                             std::span(masks).subspan(range.begin / 64),
                             {.target = target,
                              .range = range,
                              .row_words = MaskWords(kObjects)});
             }},
            counts, context, result);
    for (WorkingSet* set : memory) {
      RunWork({"one query, " + set->name(), set->objects(),
               static_cast<double>(set->objects()), set->mask(),
               [&](const Range& range) {
                 SurvivorMask(set->view().simplex(), queries.simplices()[0],
                              std::span(set->mask()).subspan(range.begin / 64),
                              {.target = target, .range = range});
               }},
              counts, context, result);
    }
  } catch (const std::system_error& error) {
    result.not_reached.push_back(
        std::string("threads: no thread can be started: ") + error.what());
  }
  return result;
}

}  // namespace halfspace::bench
