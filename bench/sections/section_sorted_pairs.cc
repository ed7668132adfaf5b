#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/baselines/box_tree.h"
#include "bench/measure/two_threads.h"
#include "bench/sections/sorted_parts.h"
#include "bench/worlds/box_set.h"
#include "halfspace/sorted.h"
#include "halfspace/sorted_pairs.h"

namespace halfspace::bench {
namespace {

using Sorted = SortedWorld<AabbView3>;

// Of more, CGAL and the sweep take seconds, many times as long as Embree.
constexpr std::size_t kMostOfSlow = 100'000;

// One after the other.
Timing Sum(const Timing& a, const Timing& b) {
  Timing sum = a;
  for (std::size_t i = 0; i < sum.samples.size(); ++i) {
    sum.samples[i] += b.samples[i];
  }
  return sum;
}

class PairContest {
 public:
  PairContest(const BoxSet<3>& set, Throughput& throughput)
      : set_(set),
        throughput_(throughput),
        target_(throughput.targets().front()),
        world_(set.boxes) {
    expected_ = Pairs(world_, {}, {.target = target_});
    pairs_.resize(expected_);
    found_.reserve(expected_);
  }

  void Run(SortedResult& result) {
    ours_built_ = Add(
        "pairs", [this] { return Pairs(world_, pairs_, {.target = target_}); });
    ours_ = Add("fast build and pairs", [this] {
      return Pairs(Sorted(set_.boxes, Order::kFast), pairs_,
                   {.target = target_});
    });
    AddEmbree();
    if (set_.boxes.size() <= kMostOfSlow) {
      AddCgal();
      Add("sweep and pairs, our own", [this] {
        MakeSweep(set_.boxes)->Pairs(found_);
        return found_.size();
      });
    }
    const bool has_threads = AddTwoThreads();

    constexpr std::size_t kFew = 3;
    const Timings timings = throughput_.TimeRuns(std::move(cases_), kFew);
    Timings with_build;
    for (std::size_t c : cgal_) with_build.push_back(timings[c]);
    if (embree_ != nullptr) {
      with_build.push_back(Sum(timings[embree_build_], timings[built_[0]]));
    }
    AddJobs(timings, set_.boxes.size(), result);
    const std::string of = " of " + Grouped(set_.boxes.size());
    if (built_.empty()) {
      throughput_.NotReached("threshold 4, pairs: built without a competitor");
    } else {
      throughput_.AddRatio(
          thresholds::kPairs, target_, "pairs" + of + ": times the fastest",
          RatioOf(timings[FastestOf(timings, built_)], timings[ours_built_]));
      throughput_.AddRatio(
          thresholds::kPairsAndBuild, target_,
          "pairs and build" + of + ": times the fastest",
          RatioOf(*std::min_element(with_build.begin(), with_build.end(),
                                    [](const Timing& a, const Timing& b) {
                                      return a.Median() < b.Median();
                                    }),
                  timings[ours_]));
    }
    if (has_threads) {
      throughput_.AddRatio(thresholds::kPairsTwoThreads, target_,
                           "pairs" + of + ": times as fast on two threads",
                           RatioOf(timings[ours_built_], timings.back()));
    } else {
      throughput_.NotReached("threshold 4, two threads: none can be started");
    }
  }

 private:
  // run() returns how many pairs there are. The place of the case.
  template <typename Run>
  std::size_t Add(std::string name, Run run) {
    Case c;
    c.name = std::move(name);
    c.run = [run] { std::ignore = run(); };
    c.check = [this, run]() -> std::string {
      const std::size_t count = run();
      if (count == expected_) return {};
      return std::to_string(count) + " pairs, and not " +
             std::to_string(expected_);
    };
    cases_.push_back(std::move(c));
    return cases_.size() - 1;
  }

  void AddEmbree() {
    embree_ = MakeEmbreePairs(set_.boxes);
    if (embree_ == nullptr) return;
    built_.push_back(Add("Embree, pairs", [this] {
      embree_->Pairs(found_);
      return found_.size();
    }));
    embree_build_ = Add("Embree, build", [this] {
      std::ignore = MakeEmbreePairs(set_.boxes);
      return expected_;
    });
  }

  void AddCgal() {
    for (std::ptrdiff_t cutoff : {10, 100, 1000}) {
      std::shared_ptr<PairFinder> cgal = MakeCgalPairs(set_.boxes, cutoff);
      if (cgal == nullptr) return;
      cgal_.push_back(
          Add("CGAL, cutoff " + std::to_string(cutoff), [this, cgal] {
            cgal->Pairs(found_);
            return found_.size();
          }));
      built_.push_back(cgal_.back());
    }
  }

  // Each thread takes half of the parts, a few at a time, as these take unequal
  // times.
  bool AddTwoThreads() {
    half_.resize(expected_);
    try {
      other_ = std::make_unique<OtherThread>(
          [this] { other_count_ = PairsOfHalf(1, half_); });
    } catch (const std::system_error&) {
      return false;
    }
    Add("pairs on two threads", [this] {
      other_->Start();
      const std::size_t count = PairsOfHalf(0, pairs_);
      other_->Wait();
      return count + other_count_;
    });
    return true;
  }

  std::size_t PairsOfHalf(std::size_t half, Span<IdPair> pairs) const {
    constexpr std::size_t kParts = 16;
    const std::size_t parts = PairParts(world_);
    std::size_t count = 0;
    for (std::size_t begin = half * kParts; begin < parts;
         begin += 2 * kParts) {
      count +=
          Pairs(world_, {pairs.data() + count, pairs.size() - count},
                {.begin = begin, .end = begin + kParts, .target = target_});
    }
    return count;
  }

  const BoxSet<3>& set_;
  Throughput& throughput_;
  Target target_;
  Sorted world_;
  std::size_t expected_;
  std::vector<IdPair> pairs_;
  std::vector<IdPair> half_;
  std::vector<IndexPair> found_;
  std::unique_ptr<PairFinder> embree_;
  std::vector<Case> cases_;
  std::size_t ours_ = 0;
  std::size_t ours_built_ = 0;
  std::vector<std::size_t> built_;  // cases of competitors, Embree's first
  std::vector<std::size_t> cgal_;   // which builds and finds at once
  std::size_t embree_build_ = 0;
  std::size_t other_count_ = 0;
  std::unique_ptr<OtherThread> other_;
};

}  // namespace

void RunSortedPairs(const BoxSet<3>& set, Throughput& throughput,
                    SortedResult& result) {
  PairContest(set, throughput).Run(result);
}

}  // namespace halfspace::bench
