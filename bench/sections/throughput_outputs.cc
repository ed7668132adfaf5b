#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "bench/sections/throughput.h"
#include "halfspace/transform.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kObjects = std::size_t{1} << 16;
// With 65 survivors each, 512 queries have more branches than a predictor
// learns. Growing 20 000 queries would take 14 s.
constexpr std::size_t kMostGrown = 512;
constexpr std::size_t kSurvivorsInOne = 1000;  // 1 in so many, or fewer

std::size_t CountAs(ShapeKind shape, const AaboView3& view,
                    const Aabo3& query) {
  return WithShape(shape, view, query, [](const auto& v, const auto& q) {
    return CountSurvivors(v, q);
  });
}

// Grown until 1 in 1000 objects survive, and no more. Those that have more from
// the start are left out.
std::vector<Aabo3> GrownQueries(const Workload& workload, ShapeKind shape,
                                const AaboView3& view) {
  const std::size_t most = view.size / kSurvivorsInOne;
  std::vector<Aabo3> grown;
  // What the query before has grown by is where the search begins.
  float before = 1.0f;
  for (const Aabo3& query : workload.timed_queries) {
    if (grown.size() == kMostGrown) break;
    const auto fits = [&](float margin) {
      return CountAs(shape, view, InflateByBox(query, margin)) <= most;
    };
    float low = 0.875f * before;
    if (!fits(low)) {
      if (!fits(0.0f)) continue;
      low = 0.0f;
    }
    float high = 1.125f * before;
    while (high < 1e30f && fits(high)) {
      low = high;
      high *= 2.0f;
    }
    while (high - low > high / 32.0f) {
      const float middle = 0.5f * (low + high);
      (fits(middle) ? low : high) = middle;
    }
    before = high;
    grown.push_back(InflateByBox(query, low));
  }
  return grown;
}

// one shape: lists of indices against masks.
class ListsAndMasks {
 public:
  ListsAndMasks(const Workload& workload, ShapeKind shape)
      : shape_(shape),
        world_(ResizedTo(workload.objects, kObjects)),
        queries_(GrownQueries(workload, shape, world_.view())),
        mask_(MaskWords(kObjects)),
        indices_(kObjects) {}

  void Run(Target target, Throughput& throughput) {
    const std::string name = NameOf(target) + "/" + NameOf(shape_);
    if (queries_.empty()) {
      throughput.NotReached("" + name + ": all queries have more survivors");
      return;
    }
    const Options options{.target = target};
    const Timings timings = throughput.Time(
        {CaseOf("mask/" + name,
                [this, options](const auto& view, const auto& query) {
                  SurvivorMask(view, query, mask_, options);
                }),
         CaseOf("indices/" + name,
                [this, options](const auto& view, const auto& query) {
                  std::ignore = Survivors(view, query, indices_, options);
                })});
    ThroughputRow row;
    row.objects = kObjects;
    row.queries = 1;
    row.working_set = "65536";
    row.target = NameOf(target);
    row.name = std::string(NameOf(shape_)) + ", mask, 1 in 1000";
    row.ns_per_pair = timings[0].Median();
    row.ceiling = throughput.AddRow(row);
    row.percent_of_ceiling = 100.0 * RatioOf(timings[0], timings[1]).median;
    row.name = std::string(NameOf(shape_)) + ", indices, 1 in 1000";
    row.ns_per_pair = timings[1].Median();
    throughput.AddRow(row);
    throughput.AddRatio(aims::kIndicesOverMask, target,
                        std::string(NameOf(shape_)) + ", " + row.target +
                            ": indices over mask at 1 survivor in 1000",
                        RatioOf(timings[1], timings[0]));
  }

 private:
  template <typename Call>
  Case CaseOf(std::string name, const Call& call) {
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(kObjects);
    c.run = [this, call, next = std::size_t{0}]() mutable {
      WithShape(shape_, world_.view(), queries_[next], call);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    };
    return c;
  }

  ShapeKind shape_;
  AaboWorld3 world_;
  std::vector<Aabo3> queries_;
  std::vector<std::uint64_t> mask_;
  std::vector<std::uint32_t> indices_;
};

}  // namespace

void AddOutputParts(const Workload& workload, ThroughputParts& parts) {
  parts.push_back([&workload](Throughput& throughput) {
    for (ShapeKind shape : kShapes) {
      ListsAndMasks outputs(workload, shape);
      for (Target target : throughput.targets()) {
        outputs.Run(target, throughput);
      }
    }
  });
}

}  // namespace halfspace::bench
