#include <algorithm>
#include <array>
#include <cstddef>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/baselines/box_tree.h"
#include "bench/sections/sorted_builds.h"
#include "bench/worlds/box_set.h"
#include "halfspace/sorted.h"

namespace halfspace::bench {
namespace {

// One after the other, and again. What was built ends between two of them, as
// its end is no part of a build.
class Builds {
 public:
  using Make = std::function<std::shared_ptr<const void>()>;

  void Add(const char* name, Make make) {
    makes_.push_back(std::move(make));
    timings_.emplace_back();
    timings_.back().name = std::string("sorted/build/") + name;
    timings_.back().iterations = 1;
  }

  Timings Time(std::size_t repetitions) {
    // The first ones find memory that nobody has used.
    for (std::size_t r = 0; r <= repetitions; ++r) {
      for (std::size_t i = 0; i < makes_.size(); ++i) {
        const std::clock_t start = std::clock();
        const std::shared_ptr<const void> made = makes_[i]();
        const std::clock_t end = std::clock();
        if (r == 0) continue;
        timings_[i].samples.push_back(static_cast<double>(end - start) * 1e9 /
                                      CLOCKS_PER_SEC);
      }
    }
    return timings_;
  }

 private:
  std::vector<Make> makes_;
  Timings timings_;
};

}  // namespace

void RunSortedBuilds(const BoxSet<3>& set, Throughput& throughput,
                     SortedResult& result) {
  constexpr std::size_t kMostRepetitions = 5;
  const Target target = throughput.targets().front();
  const std::size_t objects = set.boxes.size();
  using Sorted = SortedWorld<AabbView3>;
  const std::array<const char*, 3> names = {"tight", "fast",
                                            "Boost R-tree, 16 a node"};
  Builds builds;
  builds.Add(names[0], [&] {
    return std::make_shared<const Sorted>(set.boxes, Order::kTight);
  });
  builds.Add(names[1], [&] {
    return std::make_shared<const Sorted>(set.boxes, Order::kFast);
  });
  const bool has_competitor =
      MakeBoostTree(std::span(set.boxes).first(1)) != nullptr;
  if (has_competitor) {
    builds.Add(names[2], [&] {
      return std::shared_ptr<const BoxTree<3>>(MakeBoostTree(set.boxes));
    });
  }
  const Timings timings =
      builds.Time(std::min(throughput.repetitions(), kMostRepetitions));
  throughput.AddTimings(timings);
  for (std::size_t i = 0; i < timings.size(); ++i) {
    result.builds.push_back({names[i], objects, timings[i].Median() / 1e6});
  }
  const std::string size = Grouped(objects);
  if (has_competitor) {
    throughput.AddRatio(thresholds::kFastBuild, target,
                        "fast build of " + size + ": times Boost's bulk load",
                        RatioOf(timings[2], timings[1]));
    throughput.AddRatio(thresholds::kTightBuild, target,
                        "tight build of " + size + ": times Boost's bulk load",
                        RatioOf(timings[2], timings[0]));
  } else {
    throughput.NotReached("threshold 2, builds: built without Boost.Geometry");
  }
  const Sorted world(set.boxes);
  const auto floats =
      static_cast<double>(objects * detail::kPlaneCount<Aabb3> * sizeof(float));
  throughput.AddRatio(thresholds::kSortedMemory, target,
                      "bytes beyond the floats, over the floats, of " + size,
                      static_cast<double>(world.bytes()) / floats - 1.0);
}

}  // namespace halfspace::bench
