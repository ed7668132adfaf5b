#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/baselines/box_tree.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/sections/sorted_parts.h"
#include "bench/worlds/box_set.h"
#include "halfspace/sorted.h"

namespace halfspace::bench {
namespace {

using Sorted = SortedWorld<AabbView3>;
using Ids = std::vector<std::uint32_t>;

// One kind of search, by a sorted world and by others, over queries of a type.
template <typename Query>
class Search {
 public:
  // expected(query) is a number that tells a right answer: how many, or a sum
  // of ids.
  Search(std::string name, const std::vector<Query>& queries,
         Throughput& throughput)
      : queries_(queries), throughput_(throughput) {
    workload_.name = std::move(name);
  }

  // answer(query) gives the same number for all that are added. It is asked
  // `per_run` of the queries in a run, and the next ones in the next.
  template <typename Answer>
  void Add(std::string name, std::string target, std::size_t per_run,
           Answer answer) {
    SortedRow row;
    row.name = std::move(name);
    row.target = std::move(target);
    Case c = InTurn(
        workload_.name + "/" + row.name, queries_, queries_.size(), per_run,
        [answer](const Query& query) { std::ignore = answer(query); });
    c.check = [this, answer]() -> std::string {
      constexpr std::size_t kChecked = 20;
      std::vector<std::size_t> answers;
      for (std::size_t q = 0; q < kChecked; ++q) {
        answers.push_back(answer(queries_[q]));
      }
      if (expected_.empty()) expected_ = answers;
      return answers == expected_ ? "" : "the answers differ";
    };
    cases_.push_back(std::move(c));
    workload_.rows.push_back(std::move(row));
  }

  // The first row that was added over the competitor, the last one.
  void Run(std::size_t objects, const Threshold& threshold,
           const std::string& ratio, SortedResult& result) {
    const Timings timings =
        throughput_.TimeRuns(std::move(cases_), throughput_.repetitions());
    workload_.objects = objects;
    double sum = 0;
    for (std::size_t expected : expected_) sum += static_cast<double>(expected);
    workload_.survivors = sum / static_cast<double>(expected_.size());
    for (std::size_t i = 0; i < timings.size(); ++i) {
      workload_.rows[i].ns = timings[i].Median();
      workload_.rows[i].over_fastest =
          timings.back().Median() / timings[i].Median();
    }
    if (timings.size() > 1) {
      throughput_.AddRatio(
          threshold, throughput_.targets().front(),
          workload_.name + " of " + Grouped(objects) + ": " + ratio,
          RatioOf(timings.back(), timings.front()));
    } else {
      throughput_.NotReached("threshold 5, " + workload_.name +
                             ": built without a competitor");
    }
    result.workloads.push_back(std::move(workload_));
  }

 private:
  const std::vector<Query>& queries_;
  Throughput& throughput_;
  SortedWorkload workload_;
  std::vector<Case> cases_;
  std::vector<std::size_t> expected_;
};

constexpr float kHalfWorld = 50.0f;

}  // namespace

void RunSortedSearches(const BoxSet<3>& set, std::uint64_t seed,
                       Throughput& throughput, SortedResult& result) {
  const Target target = throughput.targets().front();
  const std::string target_name(target.name());
  const std::size_t objects = set.boxes.size();
  const auto world = std::make_shared<const Sorted>(set.boxes);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-kHalfWorld, kHalfWorld);
  // A tenth of the world: its third root of each axis.
  constexpr float kHalfSide = 0.4642f * kHalfWorld;
  std::vector<Aabb3> large;
  for (std::size_t q = 0; q < kTimedQueries; ++q) {
    Aabb3 query;
    for (std::size_t k = 0; k < 3; ++k) {
      const float center =
          place(random) * (kHalfWorld - kHalfSide) / kHalfWorld;
      query.min[k] = center - kHalfSide;
      query.max[k] = center + kHalfSide;
    }
    large.push_back(query);
  }
  Search<Aabb3> counts("counts of a tenth", large, throughput);
  counts.Add("counts", target_name, 2000, [=](const Aabb3& query) {
    return CountSurvivors(*world, query, {.target = target});
  });
  Ids found(objects);
  counts.Add("ids", target_name, 200, [=, &found](const Aabb3& query) {
    return Survivors(*world, query, found, {.target = target});
  });
  if (const std::shared_ptr<const BoxTree<3>> boost =
          MakeBoostTree(set.boxes)) {
    counts.Add("Boost R-tree, 16 a node", "", 5,
               [boost](const Aabb3& query) { return boost->Count(query); });
  }
  counts.Run(objects, thresholds::kCounts, "times Boost's count", result);
}

}  // namespace halfspace::bench
