#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/measure/groups.h"
#include "bench/measure/measure.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "halfspace/bvh.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

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

// One way to answer a query with a list of survivors.
struct Way {
  std::string shape;
  std::string schedule;    // or "BVH"
  std::string precision;   // "floats", "uint8" or "uint16"
  double survivors = 0.0;  // of a query
  Timing timing = {};      // ns of a query
  Timing with_exact = {};  // the same, and the exact test of survivors

  std::string name() const { return shape + " " + schedule + " " + precision; }
};

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

  // The fastest first.
  std::vector<Way> Measure(bench::Run& run, const std::string& name,
                           double exact_ns) {
    for (Case& c : cases_) {
      c.name = name + "/" + c.name;
      c.group = name;
    }
    // Enough for a range that another run does not leave.
    Effort effort = run.effort;
    if (run.options.repetitions == 0) effort.repetitions = kGroups;
    const std::vector<Timing> timings = run.Time(cases_, effort);
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      ways_[i].timing = ways_[i].with_exact = timings[i];
      for (double& ns : ways_[i].with_exact.samples) {
        ns += exact_ns * ways_[i].survivors;
      }
    }
    std::sort(ways_.begin(), ways_.end(), [](const Way& a, const Way& b) {
      return a.with_exact.Median() < b.with_exact.Median();
    });
    return std::move(ways_);
  }

 private:
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
    const auto sorted = std::make_shared<const Bvh<View>>(view);
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
    add("BVH", "floats", kQueriesPerRun, [this, sorted](const Query& query) {
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

// Its time over the best way's, and the range of all repetitions.
Ratio OfBest(const Way& way, const std::vector<Way>& ways) {
  std::vector<double> ratios = way.with_exact.samples;
  for (std::size_t r = 0; r < ratios.size(); ++r) {
    ratios[r] /= ways.front().with_exact.samples[r];
  }
  return GroupRange(std::move(ratios));
}

}  // namespace

Tables RunSweep(Run& run) {
  const ExactTest exact = run.TheExactTest();
  const double exact_ns = exact.ns.median;
  const Target target = run.best();
  const std::string test =
      ", with exact tests of " + Fixed(exact_ns, 0) + " ns, " + NameOf(target);
  Table own{"sweep: own workload",
            "every way to a list of survivors" + test,
            {Key("shape"), Key("schedule"), Key("precision"),
             Value("time", "us", 3), Value("survivors", "", 1),
             Value("with exact", "us", 3), Lower("of the best")}};
  const Workload& workload = run.Measured();
  const AaboWorld3 world = Thinned(
      workload.objects, run.is_quick() ? kMostOwnObjects / 8 : kMostOwnObjects);
  const std::vector<Way> ways =
      Contestants(world, workload.timed_queries, target)
          .Measure(run, "sweep/own", exact_ns);
  for (const Way& way : ways) {
    own.Add({way.shape, way.schedule, way.precision, way.timing.Median() / 1e3,
             way.survivors, way.with_exact.Median() / 1e3, OfBest(way, ways)});
  }
  own.notes = {Grouped(world.size()) + " objects of " +
               (run.input() != nullptr ? workload.name : "the scene") + "."};
  // The page needs the answers alone.
  if (run.is_page()) {
    run.tables.push_back(own);
    return {};
  }
  return {own};
}

}  // namespace halfspace::bench
