#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/schedules.h"
#include "bench/baselines/gated_scan.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "halfspace/sorted.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kMostOwnObjects = std::size_t{1} << 20;
constexpr std::size_t kCountedQueries = 256;
// Of a scan that takes few, a run has more queries, up to so many.
constexpr std::size_t kQueriesPerRun = 64;

template <typename Query>
std::vector<Query> QueriesAs(std::span<const Aabo3> aabos) {
  std::vector<Query> queries;
  for (const Aabo3& aabo : aabos) queries.push_back(SeenAs<Query>(aabo));
  return queries;
}

// Of pairs of objects and queries, the share whose slabs on X overlap.
double SlabOverlap(const AaboView3& view, std::span<const Aabo3> queries) {
  std::size_t overlapping = 0;
  for (const Aabo3& query : queries) {
    for (std::size_t i = 0; i < view.size; ++i) {
      overlapping +=
          view.min[0][i] <= query.max[0] && view.max[0][i] >= query.min[0] ? 1
                                                                           : 0;
    }
  }
  return static_cast<double>(overlapping) /
         (static_cast<double>(view.size) * static_cast<double>(queries.size()));
}

// Every way to query one world.
class Contestants {
 public:
  Contestants(const AaboWorld3& world, std::span<const Aabo3> queries,
              Target target)
      : view_(world.view()), aabos_(queries), target_(target) {
    indices_.resize(view_.size);
    AddShape(ShapeKind::kSimplex, view_.simplex(),
             QueriesAs<DownSimplex3>(queries));
    AddShape(ShapeKind::kAabb, view_.aabb(), QueriesAs<Aabb3>(queries));
    AddShape(ShapeKind::kAabo, view_, QueriesAs<Aabo3>(queries));
  }

  SweepCell Run(std::string_view name, double exact_ns,
                const Context& context) {
    for (Case& c : cases_) {
      c.name = std::string(name) + "/" + c.name;
      c.group = name;
    }
    const Timings timings = TimeCases(cases_, context.effort, context);
    SweepCell cell;
    cell.objects = view_.size;
    cell.slab_overlap =
        SlabOverlap(view_, aabos_.first(std::min<std::size_t>(
                               aabos_.size(), 1 + 2'000'000 / view_.size)));
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      Way& way = ways_[i];
      way.ns = timings[i].Median();
      way.low = timings[i].Quantile(0.25);
      way.high = timings[i].Quantile(0.75);
      for (double ns : timings[i].samples) {
        way.samples.push_back(ns + exact_ns * way.survivors);
      }
      way.ns_with_exact = way.ns + exact_ns * way.survivors;
      if (way.ns_with_exact < ways_[cell.best].ns_with_exact) cell.best = i;
    }
    for (Way& way : ways_) {
      way.of_best = RatioOf(way.samples, ways_[cell.best].samples);
    }
    cell.is_tie = IsTie(cell.best);
    cell.ways = std::move(ways_);
    return cell;
  }

 private:
  // Whether the next best way is within the spread of the best.
  bool IsTie(std::size_t best) const {
    return std::any_of(ways_.begin(), ways_.end(), [&](const Way& way) {
      return &way != &ways_[best] && way.of_best.low <= 1.0;
    });
  }

  template <typename View, typename Query>
  void AddShape(ShapeKind shape, const View& view, std::vector<Query> queries) {
    const auto own =
        std::make_shared<const std::vector<Query>>(std::move(queries));
    std::vector<std::size_t> counts;
    std::size_t sum = 0;
    for (std::size_t q = 0; q < std::min(kCountedQueries, own->size()); ++q) {
      counts.push_back(
          CountSurvivors(view, (*own)[q], {.schedule = Schedule::kFlat}));
      sum += counts.back();
    }
    const double survivors =
        static_cast<double>(sum) / static_cast<double>(counts.size());
    const auto expected =
        std::make_shared<const std::vector<std::size_t>>(counts);
    const auto bytes = std::make_shared<const QuantizedWorld<View>>(view);
    const auto words =
        std::make_shared<const QuantizedWorld<View, std::uint16_t>>(view);
    const auto sorted = std::make_shared<const SortedWorld<View>>(view);
    const std::size_t in_a_scan = std::clamp<std::size_t>(
        (std::size_t{1} << 16) / view_.size, 1, kQueriesPerRun);
    const auto add = [&](std::string schedule, std::string precision,
                         std::size_t per_run, auto find) {
      Way way;
      way.shape = NameOf(shape);
      way.schedule = std::move(schedule);
      way.precision = std::move(precision);
      way.survivors = survivors;
      Case c =
          InTurn(way.name(), *own, own->size(), per_run,
                 [find](const Query& query) { std::ignore = find(query); });
      c.run = [own, run = std::move(c.run)] { run(); };
      c.check = [own, expected, find]() -> std::string {
        for (std::size_t q = 0; q < expected->size(); ++q) {
          if (find((*own)[q]) != (*expected)[q]) {
            return "query " + std::to_string(q) +
                   ": the survivors are not as many as a flat scan finds";
          }
        }
        return {};
      };
      cases_.push_back(std::move(c));
      ways_.push_back(std::move(way));
    };
    for (const NamedSchedule& schedule : SchedulesOf(shape)) {
      const Options options{.schedule = schedule.schedule, .target = target_};
      add(schedule.name, "floats", in_a_scan,
          [this, view, options](const Query& query) {
            return Survivors(view, query, indices_, options);
          });
      add(schedule.name, "uint8", in_a_scan,
          [this, bytes, options](const Query& query) {
            return Survivors(*bytes, query, indices_, options);
          });
      add(schedule.name, "uint16", in_a_scan,
          [this, words, options](const Query& query) {
            return Survivors(*words, query, indices_, options);
          });
    }
    add("sorted", "floats", kQueriesPerRun, [this, sorted](const Query& query) {
      return Survivors(*sorted, query, indices_, {.target = target_});
    });
  }

  AaboView3 view_;
  std::span<const Aabo3> aabos_;
  Target target_;
  std::vector<std::uint32_t> indices_;
  std::vector<Case> cases_;
  std::vector<Way> ways_;
};

std::vector<double> SizesOf(bool is_quick) {
  if (is_quick) return {0.001, 0.01, 0.1};
  return {0.001, 0.003, 0.01, 0.03, 0.1, 0.3};
}

std::vector<std::size_t> CountsOf(bool is_quick) {
  if (is_quick) return {1000, 100'000};
  return {1000, 10'000, 100'000};
}

// A scene whose clouds are that much of the world's side wide.
Workload SceneOf(double size, std::size_t objects, std::uint64_t seed) {
  Workload scene = MakeScene(
      objects, kTimedQueries, seed, [](double) {},
      static_cast<float>(size) * kSceneSide / 2);
  scene.timed_queries = scene.queries;
  return scene;
}

void AddMapPoints(double size, std::uint64_t seed, const Context& context,
                  std::vector<MapPoint>& map) {
  constexpr std::size_t kObjects = 4 * kWidestGate;
  const Target target = context.targets.front();
  std::vector<std::size_t> widths = {16, 64, 256, 1024, kWidestGate};
  std::erase_if(widths, [&](std::size_t w) { return w < target.lanes(); });
  const Workload scene = SceneOf(size, kObjects, seed);
  WorkingSet set(scene, {"map", kObjects, "", 0});
  const double overlap =
      SlabOverlap(set.view(), std::span(scene.queries).first(kCountedQueries));
  std::vector<Case> cases;
  for (std::size_t w : widths) {
    for (ShapeKind shape : {ShapeKind::kSimplex, ShapeKind::kAabb}) {
      Case c = set.GatedCase("map/" + std::to_string(size) + "/w" +
                                 std::to_string(w) + "/" + NameOf(shape),
                             shape, target, w);
      c.group = std::to_string(w);
      cases.push_back(std::move(c));
    }
  }
  const Timings timings = TimeCases(cases, context.effort, context);
  for (std::size_t i = 0; i < widths.size(); ++i) {
    map.push_back(
        {widths[i], overlap, RatioOf(timings[2 * i], timings[2 * i + 1])});
  }
}

}  // namespace

SweepResult RunSweep(const Workload& workload, const ExactTest& exact,
                     std::uint64_t seed, bool is_quick,
                     const Context& context) {
  SweepResult result;
  const Target target = context.targets.front();
  result.target = target.name();
  result.exact_ns = exact.ns;
  result.exact_test = exact.name;
  const std::vector<double> sizes = SizesOf(is_quick);
  const std::vector<std::size_t> counts = CountsOf(is_quick);
  const std::size_t parts = sizes.size() * (counts.size() + 1) + 1;
  std::size_t part = 0;
  context.progress.BeginPart(part++, parts);
  {
    const AaboWorld3 own = Thinned(
        workload.objects, is_quick ? kMostOwnObjects / 8 : kMostOwnObjects);
    result.own = Contestants(own, workload.timed_queries, target)
                     .Run("sweep/own", exact.ns, context);
  }
  for (double size : sizes) {
    for (std::size_t objects : counts) {
      context.progress.BeginPart(part++, parts);
      const Workload scene = SceneOf(size, objects, seed);
      SweepCell cell = Contestants(scene.objects, scene.timed_queries, target)
                           .Run("sweep/" + std::to_string(size) + "/" +
                                    std::to_string(objects),
                                exact.ns, context);
      cell.size = size;
      result.cells.push_back(std::move(cell));
    }
    context.progress.BeginPart(part++, parts);
    AddMapPoints(size, seed, context, result.map);
  }
  return result;
}

}  // namespace halfspace::bench
