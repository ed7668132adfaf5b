#include "halfspace/bvh_pairs.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/box_tree.h"
#include "bench/sections/bvh_parts.h"
#include "bench/worlds/box_set.h"
#include "halfspace/bvh.h"

namespace halfspace::bench {
namespace {

using Bvh = Bvh<AabbView3>;

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

  void Run(BvhResult& result) {
    ours_built_ = Add(
        "pairs", [this] { return Pairs(world_, pairs_, {.target = target_}); });
    ours_ = Add("fast build and pairs", [this] {
      return Pairs(Bvh(set_.boxes, {.quality = BuildQuality::kFast}), pairs_,
                   {.target = target_});
    });
    AddSet();
    AddEmbree();
    if (set_.boxes.size() <= kMostOfSlow) {
      AddCgal();
      Add("sweep and pairs, our own", [this] {
        MakeSweep(set_.boxes)->Pairs(found_);
        return found_.size();
      });
    }
    constexpr std::size_t kFew = 3;
    const Timings timings = throughput_.TimeRuns(cases_, kFew);
    for (std::size_t c = 0; c < cases_.size(); ++c) {
      result.AddJob(cases_[c].name, set_.boxes.size(), timings[c]);
    }
    Timings with_build;
    for (std::size_t c : cgal_) with_build.push_back(timings[c]);
    if (embree_ != nullptr) {
      with_build.push_back(Sum(timings[embree_build_], timings[built_[0]]));
    }
    const std::string of = " of " + Grouped(set_.boxes.size());
    if (built_.empty()) {
      throughput_.NotReached("pairs: built without a competitor");
    } else {
      throughput_.AddRatio(
          aims::kPairs, target_, "pairs" + of + ": times the fastest",
          RatioOf(timings[FastestOf(timings, built_)], timings[ours_built_]));
      throughput_.AddRatio(
          aims::kPairsAndBuild, target_,
          "pairs and build" + of + ": times the fastest",
          RatioOf(*std::min_element(with_build.begin(), with_build.end(),
                                    [](const Timing& a, const Timing& b) {
                                      return a.Median() < b.Median();
                                    }),
                  timings[ours_]));
    }
  }

 private:
  // run() returns how many pairs there are. The place of the case.
  template <typename Run>
  std::size_t Add(std::string name, Run run) {
    return Add(std::move(name), run, expected_);
  }
  template <typename Run>
  std::size_t Add(std::string name, Run run, std::size_t expected) {
    Case c;
    c.name = std::move(name);
    c.run = [run] { std::ignore = run(); };
    c.check = [expected, run]() -> std::string {
      const std::size_t count = run();
      if (count == expected) return {};
      return std::to_string(count) + " pairs, and not " +
             std::to_string(expected);
    };
    cases_.push_back(std::move(c));
    return cases_.size() - 1;
  }

  // The pairs of a few objects, and a query for each.
  void AddSet() {
    constexpr std::size_t kObjects = 256;
    const std::size_t step =
        std::max<std::size_t>(1, set_.boxes.size() / kObjects);
    for (std::size_t i = 0; i < set_.boxes.size(); i += step) {
      moved_.push_back(static_cast<std::uint32_t>(i));
    }
    world_.Reserve(world_.size());  // as if they had been moved by id
    std::vector<bool> is_moved(set_.boxes.size());
    for (std::uint32_t id : moved_) is_moved[id] = true;
    std::ignore = Pairs(world_, pairs_, {.target = target_});
    std::size_t of_set = 0;
    std::size_t survivors = moved_.size();  // themselves
    for (const IdPair& pair : pairs_) {
      of_set += is_moved[pair.a] || is_moved[pair.b] ? 1 : 0;
      survivors += is_moved[pair.a] ? 1 : 0;
      survivors += is_moved[pair.b] ? 1 : 0;
    }
    const std::string objects = std::to_string(moved_.size());
    Add(
        "pairs of " + objects + " objects",
        [this] { return PairsOf(world_, moved_, pairs_, {.target = target_}); },
        of_set);
    found_ids_.resize(set_.boxes.size());
    Add(
        objects + " queries",
        [this] {
          std::size_t count = 0;
          for (std::uint32_t id : moved_) {
            count += Survivors(world_, set_.boxes[id], found_ids_,
                               {.target = target_});
          }
          return count;
        },
        survivors);
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

  const BoxSet<3>& set_;
  Throughput& throughput_;
  Target target_;
  Bvh world_;
  std::size_t expected_;
  std::vector<IdPair> pairs_;
  std::vector<IndexPair> found_;
  std::vector<std::uint32_t> moved_;
  std::vector<std::uint32_t> found_ids_;
  std::unique_ptr<PairFinder> embree_;
  std::vector<Case> cases_;
  std::size_t ours_ = 0;
  std::size_t ours_built_ = 0;
  std::vector<std::size_t> built_;  // cases of competitors, Embree's first
  std::vector<std::size_t> cgal_;   // which builds and finds at once
  std::size_t embree_build_ = 0;
};

}  // namespace

void RunBvhPairs(const BoxSet<3>& set, Throughput& throughput,
                 BvhResult& result) {
  PairContest(set, throughput).Run(result);
}

}  // namespace halfspace::bench
