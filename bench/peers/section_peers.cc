#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "bench/crossover_size.h"
#include "bench/peers/box_tree.h"
#include "bench/scene.h"
#include "bench/throughput.h"
#include "halfspace/codes.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::array<std::size_t, 4> kSizes = {100, 1000, 10000, 100000};
constexpr std::size_t kQueries = 128;
constexpr double kSizeNeeded = 10000.0;

using Indices = std::vector<std::uint32_t>;

// A world of boxes and the trees over it; one query at a time.
class Boxes {
 public:
  Boxes(std::size_t objects, std::uint64_t seed, Target target)
      : target_(target) {
    const Workload scene =
        MakeScene(objects, kQueries, seed, [](double /*done*/) {});
    std::vector<Aabb3> boxes;
    for (std::size_t i = 0; i < objects; ++i) {
      boxes.push_back(scene.objects.Get(i).aabb());
    }
    for (const Aabo3& query : scene.queries) {
      queries_.push_back(query.aabb());
    }
    coded_ = CodedWorld<AabbView3>(boxes);
    indices_.resize(objects);
    boost_ = MakeBoostTree(boxes);
    bullet_ = MakeBulletTree(boxes);
  }

  // The scan, and the two trees.
  std::vector<Case> Cases() {
    const std::string size = std::to_string(coded_.size());
    return {CaseOf("peers/scan/" + size,
                   [this](const Aabb3& query) { return Scan(query); }),
            TreeCase("peers/boost-rtree/" + size, *boost_),
            TreeCase("peers/bullet-dbvt/" + size, *bullet_)};
  }

 private:
  std::size_t Scan(const Aabb3& query) {
    return Survivors(coded_, query, indices_, {.target = target_});
  }

  Case TreeCase(std::string name, const BoxTree& tree) {
    Case c = CaseOf(std::move(name), [this, &tree](const Aabb3& query) {
      tree.Find(query, found_);
      return found_.size();
    });
    c.check = [this, &tree]() -> std::string {
      for (const Aabb3& query : queries_) {
        const std::size_t count = Scan(query);
        tree.Find(query, found_);
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

  template <typename Find>
  Case CaseOf(std::string name, const Find& find) {
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(queries_.size());
    c.run = [this, find] {
      std::size_t found = 0;
      for (const Aabb3& query : queries_) found += find(query);
      KeepResult(static_cast<std::uint32_t>(found));
    };
    return c;
  }

  Target target_;
  CodedWorld<AabbView3> coded_;
  std::vector<Aabb3> queries_;
  Indices indices_;
  Indices found_;
  std::unique_ptr<BoxTree> boost_;
  std::unique_ptr<BoxTree> bullet_;
};

void RunPeers(std::uint64_t seed, Throughput& throughput) {
  const Target target = throughput.targets().front();
  constexpr std::array<const char*, 3> kNames = {
      "aabb uint8 confirmed, indices", "peer: Boost.Geometry R-tree",
      "peer: Bullet btDbvt"};
  std::vector<double> sizes;
  std::array<std::vector<double>, kNames.size()> times;
  for (std::size_t objects : kSizes) {
    Boxes boxes(objects, seed, target);
    const Timings timings = throughput.Time(boxes.Cases());
    sizes.push_back(static_cast<double>(objects));
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      times[i].push_back(timings[i].Median());
      ThroughputRow row;
      row.name = kNames[i];
      row.objects = objects;
      row.queries = 1;
      row.working_set = "boxes";
      if (i == 0) row.target = target.name();
      row.ns_per_pair = timings[i].Median() / static_cast<double>(objects);
      throughput.AddRow(row);
    }
  }
  for (std::size_t i = 1; i < kNames.size(); ++i) {
    throughput.AddAtLeast(8,
                          std::string("objects up to which a coded scan beats "
                                      "the ") +
                              kNames[i],
                          CrossoverSize(sizes, times[0], times[i]),
                          kSizeNeeded);
  }
}

}  // namespace

void AddPeerParts(std::uint64_t seed, ThroughputParts& parts) {
  parts.push_back(
      [seed](Throughput& throughput) { RunPeers(seed, throughput); });
}

}  // namespace halfspace::bench
