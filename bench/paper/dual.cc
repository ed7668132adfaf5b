#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/counts.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kCountedPairs = std::size_t{1} << 27;
constexpr std::size_t kFewestCounted = 8;

// Rejects by the simplex, then tests the maxima of each survivor by itself.
void RejectAndRefine(WorkingSet& set, const Aabo3& query, Target target) {
  const AaboView3& view = set.view();
  RejectMask(view.simplex(), query.down(), set.mask(), {.target = target});
  for (std::size_t w = 0; w < set.mask().size(); ++w) {
    std::uint64_t& rejected = set.mask()[w];
    for (std::uint64_t left = ~rejected; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(left));
      const std::size_t i = 64 * w + bit;
      bool is_rejected = false;
      for (std::size_t k = 0; k < Aabo3::kAxes; ++k) {
        is_rejected |= view.max[k][i] < query.min[k];
      }
      rejected |= std::uint64_t{is_rejected} << bit;
    }
  }
}

// The share of batches of 1, of `lanes` and of 64 objects that need the second
// simplex.
std::array<double, 3> SecondReads(WorkingSet& set,
                                  const std::vector<Aabo3>& queries,
                                  std::size_t lanes) {
  const std::size_t counted = std::min(
      queries.size(), std::max(kFewestCounted, kCountedPairs / set.objects()));
  const std::array<std::size_t, 3> widths = {
      1, std::min<std::size_t>(lanes, 64), 64};
  std::array<double, 3> shares{};
  for (std::size_t q = 0; q < counted; ++q) {
    SurvivorMask(set.view().simplex(), queries[q].down(), set.mask());
    for (std::size_t i = 0; i < widths.size(); ++i) {
      shares[i] += static_cast<double>(
                       BatchesWithSurvivor(set.mask(), widths[i]) * widths[i]) /
                   static_cast<double>(set.objects() * counted);
    }
  }
  return shares;
}

void AddRows(Run& run, WorkingSet& set, const Workload& content, Table& table) {
  for (Target target : run.TargetsIn(set.name())) {
    const std::array<double, 3> second =
        SecondReads(set, content.timed_queries, target.lanes());
    const std::string prefix =
        "dual/" + content.name + "/" + set.name() + "/" + NameOf(target) + "/";
    const auto aabo = [&](const char* name, Schedule schedule) {
      return set.LibraryCase(prefix + name, ShapeKind::kAabo,
                             {.schedule = schedule, .target = target});
    };
    const std::vector<Timing> ns = run.Time(
        {set.LibraryCase(prefix + "simplex", ShapeKind::kSimplex,
                         {.target = target}),
         set.MakeCase(prefix + "refined", ShapeKind::kAabo,
                      [&set, target](const Aabo3& query) {
                        RejectAndRefine(set, query, target);
                      }),
         aabo("flat", Schedule::kFlat), aabo("staged", Schedule::kStaged)});
    table.Add({content.name, set.name(), NameOf(target), 100.0 * second[0],
               100.0 * second[1], 100.0 * second[2], ns[0].Median(),
               RatioOf(ns[3], ns[0]), RatioOf(ns[3], ns[2]),
               RatioOf(ns[1], ns[3])});
  }
}

}  // namespace

Tables RunDual(Run& run) {
  Table table{
      "dual",
      "how often the AABO's second simplex is read, and what that saves",
      {Key("content"), Key("set"), Key("target"), Value("of 1", "%", 3),
       Value("of a vector", "%", 3), Value("of 64", "%", 3),
       Value("simplex", "ns", 3), Lower("AABO / simplex"),
       Lower("staged / flat"), Value("refined / staged")}};
  std::size_t most = 0;
  for (WorkingSet* set : run.Sets({"L2", "memory"})) {
    AddRows(run, *set, run.Measured(), table);
    most = std::max(most, set->objects());
  }
  const Workload boxes = BoxesOf(run.Measured(), most);
  for (const WorkingSetSize& size : run.Reached({"L2", "memory"})) {
    WorkingSet set(boxes, size);
    AddRows(run, set, boxes, table);
  }
  table.notes = run.NotReached();
  table.notes.emplace_back(
      "of 1, of a vector, of 64: the share of batches of so many objects that "
      "need the second simplex. refined: the simplex, and the second one for "
      "each of its survivors.");
  return {table};
}

}  // namespace halfspace::bench
