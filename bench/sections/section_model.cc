#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/schedules.h"
#include "bench/baselines/exact_tests.h"
#include "bench/measure/cost_model.h"
#include "bench/measure/line_fit.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/measure/work_count.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "bench/worlds/random.h"
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

// Time an object over planes of one width, where nothing is rejected: the slope
// is that of a compare, the intercept that of writing the mask.
Line LineOverPlanes(const ModelCases& cases,
                    const std::array<std::size_t, kShapes.size()>& places) {
  std::array<double, kShapes.size()> planes{};
  std::array<double, kShapes.size()> ns{};
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    planes[s] = static_cast<double>(PlaneCountOf(kShapes[s]));
    ns[s] = cases[places[s]].Median();
  }
  return FitLine(planes, ns);
}

// What a call costs by itself: the intercept over sizes.
constexpr std::array<std::size_t, 4> kCallSizes = {64, 256, 512, 1024};

Case CallCase(WorkingSet& set, const Workload& workload, std::size_t objects,
              Target target) {
  return InTurn("model/call/" + std::to_string(objects), workload.timed_queries,
                kTimedQueries, 256,
                [&set, objects, target](const Aabo3& query) {
                  RejectMask(set.view().simplex(), query.down(), set.mask(),
                             {.schedule = Schedule::kFlat,
                              .target = target,
                              .range = {0, objects}});
                });
}

struct ShapePlaces {
  std::vector<std::size_t> gated;   // one for each width
  std::vector<std::size_t> kernel;  // one for each schedule
};

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

template <typename Shape>
Case TestCase(const char* name, const std::vector<std::pair<Shape, Shape>>& all,
              std::size_t& touching) {
  Case c = InTurn(std::string("exact/") + name, all, all.size(), all.size(),
                  [&touching](const std::pair<Shape, Shape>& pair) {
                    touching += Touch(pair.first, pair.second) ? 1 : 0;
                  });
  c.group = "exact";
  return c;
}

}  // namespace

std::vector<ExactTest> RunExactTests(std::uint64_t seed,
                                     const Context& context) {
  // So many that no predictor learns them, around each other as candidates are.
  constexpr float kBetween = 0.75f;
  Random random(seed);
  const auto vector = [&random](float scale) {
    Vector3 v;
    for (float& x : v) x = scale * random.Signed();
    return v;
  };
  const auto moved = [](Vector3 v, const Vector3& by) {
    for (std::size_t k = 0; k < 3; ++k) v[k] += by[k];
    return v;
  };
  const auto triangle = [&] {
    const Vector3 at = vector(kBetween);
    return Triangle{moved(vector(0.5f), at), moved(vector(0.5f), at),
                    moved(vector(0.5f), at)};
  };
  const auto ball = [&] { return Ball{vector(kBetween), 0.5f}; };
  // Turned about one axis by an angle of a Pythagorean triple: unit vectors.
  const auto box = [&] {
    OrientedBox b{vector(kBetween), {}, {0.5f, 0.3f, 0.2f}};
    const std::size_t up = random.Below(3);
    b.axes[up][up] = 1.0f;
    const std::size_t x = (up + 1) % 3;
    const std::size_t y = (up + 2) % 3;
    b.axes[x][x] = b.axes[y][y] = 0.8f;
    b.axes[x][y] = 0.6f;
    b.axes[y][x] = -0.6f;
    return b;
  };
  std::vector<std::pair<Triangle, Triangle>> triangles;
  std::vector<std::pair<Ball, Ball>> balls;
  std::vector<std::pair<OrientedBox, OrientedBox>> boxes;
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    triangles.emplace_back(triangle(), triangle());
    balls.emplace_back(ball(), ball());
    boxes.emplace_back(box(), box());
  }
  std::size_t touching = 0;
  const std::vector<Case> cases = {
      TestCase("triangle-triangle", triangles, touching),
      TestCase("sphere-sphere", balls, touching),
      TestCase("box-box", boxes, touching)};
  const Timings timings = TimeCases(cases, context.effort, context);
  KeepResult(static_cast<std::uint32_t>(touching));
  std::vector<ExactTest> tests;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    tests.push_back(
        {std::array{"triangle-triangle", "sphere-sphere", "box-box"}[i],
         timings[i].Median(), timings[i].Quantile(0.25),
         timings[i].Quantile(0.75)});
  }
  return tests;
}

ModelResult RunModel(const Workload& workload, WorkingSet& set,
                     const QualityResult& quality,
                     std::vector<ExactTest> exact_tests,
                     const Context& context) {
  const Target target = context.targets.front();
  ModelResult result;
  result.target = target.name();
  result.working_set = set.name();
  result.objects = set.objects();
  result.exact_tests = std::move(exact_tests);
  const Counts counts = CountsOf(set, workload);
  const std::vector<std::size_t> widths = WidthsFrom(target.lanes());

  ModelCases cases;
  std::array<ShapePlaces, kShapes.size()> places;
  std::vector<std::array<std::size_t, kShapes.size()>> keeping(widths.size());
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    const ShapeKind shape = kShapes[s];
    const std::string name = std::string("model/") + NameOf(shape) + "/";
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const std::size_t w = kWorkWidths[widths[i]];
      places[s].gated.push_back(cases.Add(set.GatedCase(
          name + "gated/w" + std::to_string(w), shape, target, w)));
      keeping[i][s] = cases.Add(set.KeepingCase(
          name + "keeping/w" + std::to_string(w), shape, target, w));
    }
    for (const NamedSchedule& schedule : SchedulesOf(shape)) {
      places[s].kernel.push_back(cases.Add(
          set.LibraryCase(name + schedule.name, shape,
                          {.schedule = schedule.schedule, .target = target})));
    }
  }
  std::vector<std::size_t> calls;
  for (std::size_t size : kCallSizes) {
    calls.push_back(cases.Add(CallCase(set, workload, size, target)));
  }
  cases.Run(context);

  std::array<std::size_t, kShapes.size()> flat{};
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    flat[s] = places[s].kernel.front();
  }
  result.compare_ns = LineOverPlanes(cases, flat).slope;
  std::array<double, kCallSizes.size()> sizes{};
  std::array<double, kCallSizes.size()> call_ns{};
  for (std::size_t i = 0; i < kCallSizes.size(); ++i) {
    sizes[i] = static_cast<double>(kCallSizes[i]);
    call_ns[i] = cases[calls[i]].Median();
  }
  result.call_ns = std::max(0.0, FitLine(sizes, call_ns).intercept);

  std::vector<Line> lines;
  for (const auto& of_width : keeping) {
    lines.push_back(LineOverPlanes(cases, of_width));
  }
  const double pairs = static_cast<double>(quality.objects) *
                       static_cast<double>(quality.queries);
  for (std::size_t s = 0; s < kShapes.size(); ++s) {
    const ShapeKind shape = kShapes[s];
    ModelShape model{NameOf(shape), PlaneCountOf(shape), "", 0.0, 0.0, {}};
    model.candidates =
        static_cast<double>(Of(quality.survivors, shape)) / pairs;
    for (std::size_t k = 0; k < places[s].kernel.size(); ++k) {
      const double ns = cases[places[s].kernel[k]].Median();
      if (k == 0 || ns < model.ns_per_object) {
        model.ns_per_object = ns;
        model.schedule = SchedulesOf(shape)[k].name;
      }
    }
    for (std::size_t i = 0; i < widths.size(); ++i) {
      const Timing& gated = cases[places[s].gated[i]];
      ModelRow row;
      row.w = kWorkWidths[widths[i]];
      row.p = Of(counts.rejects, shape)[widths[i]];
      row.expected = ExpectedHalfSpaces(row.p, model.planes);
      row.counted = Of(counts.half_spaces, shape)[widths[i]];
      row.compare_ns = lines[i].slope;
      row.predicted_ns = lines[i].intercept + lines[i].slope * row.counted;
      row.measured_ns = gated.Median();
      const double scale = 1.0 / row.predicted_ns;
      row.measured_over_predicted = {row.measured_ns * scale,
                                     gated.Quantile(0.25) * scale,
                                     gated.Quantile(0.75) * scale};
      model.rows.push_back(row);
    }
    result.shapes.push_back(std::move(model));
  }
  const ModelShape& aabb = result.shapes[0];
  const ModelShape& simplex = result.shapes[1];
  const ModelShape& aabo = result.shapes[2];
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const ModelRow& box = aabb.rows[i];
    const ModelRow& own = simplex.rows[i];
    result.advantages.push_back(
        {box.w, box.expected / own.expected, box.counted / own.counted,
         box.predicted_ns / own.predicted_ns,
         RatioOf(cases[places[0].gated[i]], cases[places[1].gated[i]])});
  }
  const auto& rows = result.advantages;
  result.expected =
      LeadOf(rows, [](const AdvantageRow& row) { return row.expected; });
  result.counted =
      LeadOf(rows, [](const AdvantageRow& row) { return row.counted; });
  result.predicted =
      LeadOf(rows, [](const AdvantageRow& row) { return row.predicted; });
  result.measured =
      LeadOf(rows, [](const AdvantageRow& row) { return row.measured.median; });
  for (const ModelShape* other : {&aabb, &aabo}) {
    result.break_even.push_back(
        {other->shape,
         BreakEvenNanoseconds({simplex.ns_per_object, simplex.candidates},
                              {other->ns_per_object, other->candidates})});
  }
  return result;
}

}  // namespace halfspace::bench
