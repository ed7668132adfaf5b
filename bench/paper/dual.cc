#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/counts.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kCountedPairs = std::size_t{1} << 27;
constexpr std::size_t kFewestCounted = 8;

// The share of batches of 64 objects that need the second simplex.
double SecondReads(WorkingSet& set, const std::vector<Aabo3>& queries) {
  const std::size_t counted = std::min(
      queries.size(), std::max(kFewestCounted, kCountedPairs / set.objects()));
  std::size_t batches = 0;
  for (std::size_t q = 0; q < counted; ++q) {
    SurvivorMask(set.view().simplex(), queries[q].down(), set.mask());
    batches += BatchesWithSurvivor(set.mask());
  }
  return static_cast<double>(batches * 64) /
         static_cast<double>(set.objects() * counted);
}

}  // namespace

Tables RunDual(Run& run) {
  Table table{
      "dual",
      "how often the AABO's second simplex is read, and what that saves",
      {Key("content"), Key("set"), Key("target"), Value("of 64", "%", 3),
       Value("flat", "ns", 3), Value("staged", "ns", 3),
       Lower("staged / flat")}};
  const Workload& content = run.Measured();
  for (WorkingSet* set : run.Sets({"L2", "memory"})) {
    const double second = SecondReads(*set, content.timed_queries);
    for (Target target : run.TargetsIn(set->name())) {
      const std::string name = "dual/" + content.name + "/" + set->name() +
                               "/" + NameOf(target) + "/";
      const auto aabo = [&](const char* what, Schedule schedule) {
        return set->LibraryCase(name + what, ShapeKind::kAabo,
                                {.schedule = schedule, .target = target});
      };
      const std::vector<Timing> ns = run.Time(
          {aabo("flat", Schedule::kFlat), aabo("staged", Schedule::kStaged)});
      table.Add({content.name, set->name(), NameOf(target), 100.0 * second,
                 ns[0].Median(), ns[1].Median(), RatioOf(ns[1], ns[0])});
    }
  }
  table.notes = run.NotReached();
  table.notes.emplace_back(
      "of 64: the share of batches of 64 objects that need the second "
      "simplex.");
  return {table};
}

}  // namespace halfspace::bench
