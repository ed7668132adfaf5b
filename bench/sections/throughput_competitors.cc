#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "bench/baselines/box_tree.h"
#include "bench/measure/crossover_size.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/scene.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::array<std::size_t, 4> kSizes = {100, 1000, 10000, 100000};
constexpr std::size_t kCallsOfRun = 128;
constexpr std::size_t kChecked = 1000;

using Indices = std::vector<std::uint32_t>;

// A world of boxes and the trees over it; one query at a time.
class Boxes {
 public:
  Boxes(std::size_t objects, std::uint64_t seed, Target target)
      : target_(target) {
    const Workload scene =
        MakeScene(objects, kTimedQueries, seed, [](double /*done*/) {});
    std::vector<Aabb3> boxes;
    for (std::size_t i = 0; i < objects; ++i) {
      boxes.push_back(scene.objects.Get(i).aabb());
    }
    for (const Aabo3& query : scene.queries) {
      queries_.push_back(query.aabb());
    }
    quantized_world_ = QuantizedWorld<AabbView3>(boxes);
    indices_.resize(objects);
    boost_ = MakeBoostTree(boxes);
    bullet_ = MakeBulletTree(boxes);
  }

  // The scan, and the two trees: each with all queries, and with few.
  std::vector<Case> Cases() {
    std::vector<Case> cases;
    const std::string size = std::to_string(quantized_world_.size());
    for (std::size_t different : {kTimedQueries, kFewQueries}) {
      cases.push_back(
          InTurn("competitors/scan/" + size, queries_, different, kCallsOfRun,
                 [this](const Aabb3& query) { std::ignore = Scan(query); }));
      cases.push_back(
          TreeCase("competitors/boost-rtree/" + size, different, *boost_));
      cases.push_back(
          TreeCase("competitors/bullet-dbvt/" + size, different, *bullet_));
    }
    return cases;
  }

 private:
  std::size_t Scan(const Aabb3& query) {
    return Survivors(quantized_world_, query, indices_, {.target = target_});
  }

  Case TreeCase(std::string name, std::size_t different,
                const BoxTree<3>& tree) {
    Case c =
        InTurn(std::move(name), queries_, different, kCallsOfRun,
               [this, &tree](const Aabb3& query) { tree.Find(query, found_); });
    c.check = [this, &tree]() -> std::string {
      for (std::size_t q = 0; q < kChecked; ++q) {
        const std::size_t count = Scan(queries_[q]);
        tree.Find(queries_[q], found_);
        std::sort(found_.begin(), found_.end());
        if (!std::equal(
                found_.begin(), found_.end(), indices_.begin(),
                indices_.begin() + static_cast<std::ptrdiff_t>(count))) {
          return "the boxes found are not those of the scan";
        }
      }
      return {};
    };
    return c;
  }

  Target target_;
  QuantizedWorld<AabbView3> quantized_world_;
  std::vector<Aabb3> queries_;
  Indices indices_;
  Indices found_;
  std::unique_ptr<BoxTree<3>> boost_;
  std::unique_ptr<BoxTree<3>> bullet_;
};

void RunCompetitors(std::uint64_t seed, Throughput& throughput) {
  const Target target = throughput.targets().front();
  constexpr std::array<const char*, 3> kNames = {
      "AABB uint8 refined, indices", "competitor: Boost.Geometry R-tree",
      "competitor: Bullet btDbvt"};
  std::vector<double> sizes;
  std::array<std::vector<double>, kNames.size()> times;
  for (std::size_t objects : kSizes) {
    Boxes boxes(objects, seed, target);
    const Timings timings = throughput.Time(boxes.Cases());
    sizes.push_back(static_cast<double>(objects));
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      const Timing& all = timings[i];
      times[i].push_back(all.Median());
      ThroughputRow row;
      row.name = kNames[i];
      row.objects = objects;
      row.queries = 1;
      row.working_set = "boxes";
      if (i == 0) row.target = NameOf(target);
      throughput.AddRowsInTurn(row, all, timings[kNames.size() + i],
                               Throughput::Few::kAlways);
    }
  }
  for (std::size_t i = 1; i < kNames.size(); ++i) {
    throughput.AddRatio(
        aims::kTreeSize, target,
        std::string("objects up to which a quantized scan beats "
                    "the ") +
            kNames[i],
        CrossoverSize(sizes, times[0], times[i]));
  }
}

}  // namespace

void AddCompetitorParts(std::uint64_t seed, ThroughputParts& parts) {
  parts.push_back(
      [seed](Throughput& throughput) { RunCompetitors(seed, throughput); });
}

}  // namespace halfspace::bench
