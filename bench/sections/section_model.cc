#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/schedules.h"
#include "bench/measure/cost_model.h"
#include "bench/measure/line_fit.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/measure/work_count.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

// Gates whose work is counted, from the lanes of a target on: their places in
// kWorkWidths.
std::vector<std::size_t> WidthsFrom(std::size_t lanes) {
  std::vector<std::size_t> places;
  for (std::size_t i = 1; i < kWorkWidths.size(); ++i) {
    if (kWorkWidths[i] >= lanes) places.push_back(i);
  }
  return places;
}

struct Counts {
  WorkCount half_spaces;
  BatchRejects rejects;
};

Counts CountsOf(const WorkingSet& set, const Workload& workload) {
  WorkCounter counter(set.view());
  for (const Aabo3& query : workload.queries) counter.Add(query);
  return {counter.Average(), counter.RejectsPerPlane()};
}

const std::array<double, kWorkWidths.size()>& Of(const WorkCount& count,
                                                 ShapeKind shape) {
  switch (shape) {
    case ShapeKind::kAabb:
      return count.aabb;
    case ShapeKind::kSimplex:
      return count.simplex;
    case ShapeKind::kAabo:
      break;
  }
  return count.aabo;
}

template <typename T>
T Of(const PerShape<T>& values, ShapeKind shape) {
  switch (shape) {
    case ShapeKind::kAabb:
      return values.aabb;
    case ShapeKind::kSimplex:
      return values.simplex;
    case ShapeKind::kAabo:
      break;
  }
  return values.aabo;
}

// All cases of the model, timed as one group.
class ModelCases {
 public:
  std::size_t Add(Case c) {
    c.group = "model";
    cases_.push_back(std::move(c));
    return cases_.size() - 1;
  }
  void Run(const Context& context) {
    timings_ = TimeCases(cases_, context.effort, context);
  }
  const Timing& operator[](std::size_t place) const { return timings_[place]; }

 private:
  std::vector<Case> cases_;
  Timings timings_;
};

// What a call costs by itself: the intercept over sizes.
constexpr std::array<std::size_t, 4> kCallSizes = {64, 256, 512, 1024};

Case CallCase(WorkingSet& set, const Workload& workload, std::size_t objects,
              Target target) {
  Case c =
      InTurn("model/call/" + std::to_string(objects), workload.timed_queries,
             kTimedQueries, 256, [&set, objects, target](const Aabo3& query) {
               RejectMask(set.view().simplex(), query.down(), set.mask(),
                          {.schedule = Schedule::kFlat,
                           .target = target,
                           .range = {0, objects}});
             });
  c.check = [&set, &workload, objects, target]() -> std::string {
    const auto mask_of = [&](const Options& options) {
      RejectMask(set.view().simplex(), workload.timed_queries[0].down(),
                 set.mask(), options);
      return std::vector<std::uint64_t>(
          set.mask().begin(),
          set.mask().begin() + static_cast<std::ptrdiff_t>(objects / 64));
    };
    const auto whole = mask_of({.target = target});
    return mask_of({.target = target, .range = {0, objects}}) == whole
               ? ""
               : "the mask of a range is not that of the whole";
  };
  return c;
}

LeadFrom LeadOf(const std::vector<AdvantageRow>& rows,
                double (*advantage)(const AdvantageRow&)) {
  std::vector<double> widths;
  std::vector<double> costs;
  for (const AdvantageRow& row : rows) {
    widths.push_back(static_cast<double>(row.w));
    costs.push_back(1.0 / advantage(row));
  }
  return FindLead(widths, costs);
}

using ByShape = std::array<std::size_t, kShapes.size()>;

// The places of the cases.
struct Places {
  std::vector<ByShape> gated;    // of each width
  std::vector<ByShape> keeping;  // the same, where nothing is rejected
  std::array<std::vector<std::size_t>, kShapes.size()> schedules;
  std::array<std::size_t, kCallSizes.size()> calls{};
};

Places PlanCases(const Workload& workload, WorkingSet& set, Target target,
                 const std::vector<std::size_t>& widths, ModelCases& cases) {
  Places places;
  places.gated.resize(widths.size());
  places.keeping.resize(widths.size());
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    const ShapeKind shape = kShapes[s];
    const std::string name = std::string("model/") + NameOf(shape) + "/";
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const std::size_t w = kWorkWidths[widths[i]];
      const std::string gate = "w" + std::to_string(w);
      places.gated[i][s] =
          cases.Add(set.GatedCase(name + "gated/" + gate, shape, target, w));
      places.keeping[i][s] = cases.Add(
          set.KeepingCase(name + "keeping/" + gate, shape, target, w));
    }
    for (const NamedSchedule& schedule : SchedulesOf(shape)) {
      places.schedules[s].push_back(cases.Add(
          set.LibraryCase(name + schedule.name, shape,
                          {.schedule = schedule.schedule, .target = target})));
    }
  }
  for (std::size_t i = 0; i < kCallSizes.size(); ++i) {
    places.calls[i] = cases.Add(CallCase(set, workload, kCallSizes[i], target));
  }
  return places;
}

double CallNanoseconds(const ModelCases& cases, const Places& places) {
  std::array<double, kCallSizes.size()> sizes{};
  std::array<double, kCallSizes.size()> ns{};
  for (std::size_t i = 0; i < kCallSizes.size(); ++i) {
    sizes[i] = static_cast<double>(kCallSizes[i]);
    ns[i] = cases[places.calls[i]].Median();
  }
  return std::max(0.0, FitLine(sizes, ns).intercept);
}

// What one more plane costs an object in flat kernels.
double FlatCompareNanoseconds(const ModelCases& cases, const Places& places) {
  std::array<double, kShapes.size()> planes{};
  std::array<double, kShapes.size()> ns{};
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    planes[s] = static_cast<double>(PlaneCountOf(kShapes[s]));
    ns[s] = cases[places.schedules[s].front()].Median();
  }
  return FitLine(planes, ns).slope;
}

// The fastest schedule, and a row for each width.
ModelShape ShapeOf(std::size_t s, const std::vector<std::size_t>& widths,
                   const Counts& counts, const ModelCases& cases,
                   const Places& places) {
  const ShapeKind shape = kShapes[s];
  ModelShape model;
  model.shape = NameOf(shape);
  model.planes = PlaneCountOf(shape);
  for (std::size_t k = 0; k < places.schedules[s].size(); ++k) {
    const double ns = cases[places.schedules[s][k]].Median();
    if (k == 0 || ns < model.ns_per_object) {
      model.ns_per_object = ns;
      model.schedule = SchedulesOf(shape)[k].name;
      model.samples = cases[places.schedules[s][k]].samples;
    }
  }
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const Timing& gated = cases[places.gated[i][s]];
    ModelRow row;
    row.w = kWorkWidths[widths[i]];
    row.p = Of(counts.rejects, shape)[widths[i]];
    row.expected = ExpectedHalfSpaces(row.p, model.planes);
    row.counted = Of(counts.half_spaces, shape)[widths[i]];
    row.compare_ns = cases[places.keeping[i][s]].Median() /
                     static_cast<double>(model.planes);
    row.predicted_ns = row.compare_ns * row.counted;
    row.measured_ns = gated.Median();
    row.measured_over_predicted = {row.measured_ns / row.predicted_ns,
                                   gated.Quantile(0.25) / row.predicted_ns,
                                   gated.Quantile(0.75) / row.predicted_ns};
    model.rows.push_back(row);
  }
  return model;
}

BreakEven BreakEvenOf(const ModelShape& simplex, const ModelShape& other) {
  Timing saved;
  for (std::size_t i = 0; i < simplex.samples.size(); ++i) {
    saved.samples.push_back(other.samples[i] - simplex.samples[i]);
  }
  const double more = simplex.candidates - other.candidates;
  BreakEven result;
  result.against = other.shape;
  result.ns = BreakEvenNanoseconds(saved.Median(), more);
  if (result.ns) {
    result.low = std::max(0.0, saved.Quantile(0.25) / more);
    result.high = saved.Quantile(0.75) / more;
  }
  return result;
}

void AddAdvantages(const ModelCases& cases, const Places& places,
                   ModelResult& result) {
  const auto& boxes = result.shapes[0].rows;
  const auto& simplices = result.shapes[1].rows;
  std::vector<AdvantageRow>& rows = result.advantages;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    rows.push_back(
        {boxes[i].w, boxes[i].expected / simplices[i].expected,
         boxes[i].counted / simplices[i].counted,
         boxes[i].predicted_ns / simplices[i].predicted_ns,
         RatioOf(cases[places.gated[i][0]], cases[places.gated[i][1]])});
  }
  result.expected =
      LeadOf(rows, [](const AdvantageRow& row) { return row.expected; });
  result.counted =
      LeadOf(rows, [](const AdvantageRow& row) { return row.counted; });
  result.predicted =
      LeadOf(rows, [](const AdvantageRow& row) { return row.predicted; });
  result.measured =
      LeadOf(rows, [](const AdvantageRow& row) { return row.measured.median; });
}

}  // namespace

ModelResult RunModel(const Workload& workload, WorkingSet& set,
                     const QualityResult& quality,
                     std::vector<ExactTest> exact_tests,
                     const Context& context) {
  const Target target = context.targets.front();
  const std::vector<std::size_t> widths = WidthsFrom(target.lanes());
  const Counts counts = CountsOf(set, workload);
  ModelCases cases;
  const Places places = PlanCases(workload, set, target, widths, cases);
  cases.Run(context);

  ModelResult result;
  result.target = target.name();
  result.working_set = set.name();
  result.objects = set.objects();
  result.compare_ns = FlatCompareNanoseconds(cases, places);
  result.call_ns = CallNanoseconds(cases, places);
  const double pairs = static_cast<double>(quality.objects) *
                       static_cast<double>(quality.queries);
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    result.shapes.push_back(ShapeOf(s, widths, counts, cases, places));
    result.shapes[s].candidates =
        static_cast<double>(Of(quality.survivors, kShapes[s])) / pairs;
  }
  AddAdvantages(cases, places, result);
  result.exact_tests = std::move(exact_tests);
  for (std::size_t other : {0, 2}) {
    result.break_even.push_back(
        BreakEvenOf(result.shapes[1], result.shapes[other]));
  }
  return result;
}

}  // namespace halfspace::bench
