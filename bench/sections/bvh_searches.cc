#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/baselines/box_tree.h"
#include "bench/measure/measure.h"
#include "bench/sections/bvh_parts.h"
#include "bench/worlds/box_set.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_shapes.h"

namespace halfspace::bench {
namespace {

using Bvh = Bvh<AabbView3>;
using Ids = std::vector<std::uint32_t>;

struct Itself {
  template <typename Query>
  std::size_t operator()(const Query&, std::size_t answer) const {
    return answer;
  }
};

// One kind of search, by a BVH and by others, over queries of a type.
template <typename Query>
class Search {
 public:
  Search(std::string name, const std::vector<Query>& queries,
         Throughput& throughput)
      : queries_(queries), throughput_(throughput) {
    name_ = std::move(name);
  }

  // number(query, answer(query)) is the same for all that are added. `per_run`
  // of the queries are asked in a run, and the next ones in the next.
  template <typename Answer, typename Number = Itself>
  void Add(std::string name, std::string target, std::size_t per_run,
           Answer answer, Number number = {}) {
    BvhRow row;
    row.name = std::move(name);
    row.target = std::move(target);
    Case c =
        InTurn(name_ + "/" + row.name, queries_, queries_.size(), per_run,
               [answer](const Query& query) { std::ignore = answer(query); });
    c.check = [this, answer, number]() -> std::string {
      std::vector<std::size_t> answers;
      for (std::size_t q = 0; q < kChecked; ++q) {
        answers.push_back(number(queries_[q], answer(queries_[q])));
      }
      if (expected_.empty()) expected_ = answers;
      return answers == expected_ ? "" : "the answers differ";
    };
    cases_.push_back(std::move(c));
    rows_.push_back(std::move(row));
  }

  // The first row that was added over the competitor, the last one.
  void Run(std::size_t objects, const Aim& threshold, const std::string& ratio,
           BvhResult& result) {
    const Timings timings =
        throughput_.TimeRuns(std::move(cases_), throughput_.repetitions());
    const bool has_competitor = rows_.back().target.empty();
    for (std::size_t i = 0; i < timings.size(); ++i) {
      rows_[i].ns = timings[i].Median();
      if (has_competitor) {
        rows_[i].over_fastest = RatioOf(timings.back(), timings[i]);
      }
      result.AddRow(name_, objects, rows_[i]);
    }
    if (has_competitor) {
      throughput_.AddRatio(threshold, throughput_.targets().front(),
                           name_ + " of " + Grouped(objects) + ": " + ratio,
                           RatioOf(timings.back(), timings.front()));
    } else {
      throughput_.NotReached("" + name_ + ": built without a competitor");
    }
  }

 private:
  static constexpr std::size_t kChecked = 20;

  const std::vector<Query>& queries_;
  Throughput& throughput_;
  std::string name_;
  std::vector<BvhRow> rows_;
  std::vector<Case> cases_;
  std::vector<std::size_t> expected_;
};

constexpr float kHalfWorld = 50.0f;
constexpr float kFar = std::numeric_limits<float>::infinity();

}  // namespace

void RunBvhSearches(const BoxSet<3>& set, std::uint64_t seed,
                    Throughput& throughput, BvhResult& result) {
  const Target target = throughput.targets().front();
  const std::string target_name = NameOf(target);
  const std::size_t objects = set.boxes.size();
  const auto world = std::make_shared<const Bvh>(set.boxes);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> place(-kHalfWorld, kHalfWorld);
  const auto any_point = [&] {
    return Point<3>{place(random), place(random), place(random)};
  };

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
  counts.Run(objects, aims::kCounts, "times Boost's count", result);

  std::vector<Point<3>> points;
  for (std::size_t q = 0; q < kTimedQueries; ++q) points.push_back(any_point());
  constexpr std::size_t kNearestCount = 8;
  Search<Point<3>> nearest("nearest 8", points, throughput);
  // Many boxes are equally far away, so the answer is a distance: of the last.
  const auto farthest = [&set](const Point<3>& point, auto&& ids) {
    double most = 0;
    for (std::uint32_t id : ids) {
      double square = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double beyond = std::max({set.boxes[id].min[k] - point[k],
                                        point[k] - set.boxes[id].max[k], 0.0f});
        square += beyond * beyond;
      }
      most = std::max(most, square);
    }
    return static_cast<std::size_t>(1e6 * std::sqrt(most)) + ids.size();
  };
  std::array<std::uint32_t, kNearestCount> ids;
  std::array<float, kNearestCount> distances;
  nearest.Add(
      "nearest", target_name, 2000,
      [&](const Point<3>& point) {
        const std::size_t count =
            KNearest(*world, point, ids, distances, kFar, {.target = target});
        return std::span(ids).first(count);
      },
      farthest);
  if (const std::shared_ptr<NearestTree<3>> boost =
          MakeBoostNearest(set.boxes)) {
    nearest.Add(
        "Boost R-tree, 16 a node", "", 200,
        [boost, &found](const Point<3>& point) {
          boost->Nearest(point, kNearestCount, found);
          return std::span<const std::uint32_t>(found);
        },
        farthest);
  }
  nearest.Run(objects, aims::kNearest, "times Boost", result);

  std::vector<Segment<3>> segments;
  constexpr float kLength = 0.3f;  // of the way from one point to another
  for (std::size_t q = 0; q < kTimedQueries; ++q) {
    Segment<3> segment{any_point(), any_point()};
    for (std::size_t k = 0; k < 3; ++k) {
      segment.b[k] = segment.a[k] + kLength * (segment.b[k] - segment.a[k]);
    }
    segments.push_back(segment);
  }
  Search<Segment<3>> along("along a segment", segments, throughput);
  along.Add("ids", target_name, 1000, [=, &found](const Segment<3>& segment) {
    return Survivors(*world, segment, found, {.target = target});
  });
  if (const std::shared_ptr<const LineTree> embree =
          MakeEmbreeLines(set.boxes)) {
    along.Add("Embree", "", 200, [embree, &found](const Segment<3>& segment) {
      embree->Along(segment, found);
      return found.size();
    });
  }
  along.Run(objects, aims::kAlong, "times Embree", result);
}

}  // namespace halfspace::bench
