#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/box_tree.h"
#include "bench/sections/bvh_parts.h"
#include "bench/worlds/box_set.h"
#include "halfspace/bvh.h"

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
    timings_.back().name = std::string("bvh/build/") + name;
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

void RunBvhBuilds(const BoxSet<3>& set, Throughput& throughput,
                  BvhResult& result) {
  constexpr std::size_t kMostRepetitions = 5;
  const Target target = throughput.targets().front();
  const std::size_t objects = set.boxes.size();
  using Bvh = Bvh<AabbView3>;
  const std::array<const char*, 3> names = {"tight", "fast",
                                            "Boost R-tree, 16 a node"};
  Builds builds;
  builds.Add(names[0], [&] { return std::make_shared<const Bvh>(set.boxes); });
  builds.Add(names[1], [&] {
    return std::make_shared<const Bvh>(
        set.boxes, BuildOptions{.quality = BuildQuality::kFast});
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
  for (std::size_t i = 0; i < timings.size(); ++i) {
    result.AddJob(names[i], objects, timings[i]);
  }
  const std::string size = Grouped(objects);
  if (has_competitor) {
    throughput.AddRatio(aims::kFastBuild, target,
                        "fast build of " + size + ": times Boost's bulk load",
                        RatioOf(timings[2], timings[1]));
    throughput.AddRatio(aims::kTightBuild, target,
                        "tight build of " + size + ": times Boost's bulk load",
                        RatioOf(timings[2], timings[0]));
  } else {
    throughput.NotReached("builds: built without Boost.Geometry");
  }
  const Bvh world(set.boxes);
  const auto floats =
      static_cast<double>(objects * detail::kPlaneCount<Aabb3> * sizeof(float));
  throughput.AddRatio(aims::kBvhMemory, target,
                      "bytes beyond the floats, over the floats, of " + size,
                      static_cast<double>(world.bytes()) / floats - 1.0);
}

// Each is a BVH of its own, so that none finds what another has left
// in the caches.
void RunBvhRefits(const BoxSet<3>& set, Throughput& throughput,
                  BvhResult& result) {
  using Bvh = Bvh<AabbView3>;
  constexpr std::size_t kPlanes = detail::kPlaneCount<Aabb3>;
  const Target target = throughput.targets().front();
  const std::size_t objects = set.boxes.size();
  const std::span<const Aabb3> boxes = set.boxes;
  Bvh in_order(boxes);
  Bvh by_id(boxes);
  World<AabbView3> bounds;
  for (std::uint32_t id : in_order.ids()) bounds.Push(boxes[id]);

  // A refit reads the floats and writes them and the codes; a copy moves as
  // many bytes, half of them each way.
  const std::size_t moved =
      objects * kPlanes * (2 * sizeof(float) + sizeof(std::int16_t));
  std::vector<std::byte> from(moved / 2, std::byte{1});
  std::vector<std::byte> to(moved / 2);

  std::vector<Case> cases(3);
  cases[0].name = "refit, in order";
  cases[0].run = [&] { in_order.RefitInOrder(bounds.view()); };
  cases[1].name = "refit, by id, of a list";
  cases[1].run = [&] { by_id.Refit(boxes); };
  cases[2].name = "copy of as many bytes";
  cases[2].run = [&] { std::memcpy(to.data(), from.data(), to.size()); };
  for (std::size_t c = 0; c < 2; ++c) {
    cases[c].check = [&, c]() -> std::string {
      cases[c].run();
      return (c == 0 ? in_order : by_id).CostRatio() == 1.0
                 ? ""
                 : "the same bounds make another world";
    };
  }
  const Timings timings = throughput.TimeRuns(
      cases, std::max<std::size_t>(5, throughput.repetitions()));
  const std::string size = Grouped(objects);
  for (std::size_t c = 0; c < cases.size(); ++c) {
    result.AddJob(cases[c].name, objects, timings[c]);
  }
  throughput.AddRatio(aims::kRefitInOrder, target,
                      "refit of " + size + " in order: % of copying as much",
                      RatioOf(timings[2], timings[0]).Percent());
  throughput.AddRatio(aims::kRefitById, target,
                      "refit of " + size + " by id: % of copying as much",
                      RatioOf(timings[2], timings[1]).Percent());
}

}  // namespace halfspace::bench
