#include <cmath>
#include <utility>

#include "bench/baselines/gated_scan.h"
#include "bench/sections/sections.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kNoCase = static_cast<std::size_t>(-1);

// A row before it is timed: which case holds each shape.
struct PlannedRow {
  CrossoverRow row;
  PerShape<std::size_t> cases{kNoCase, kNoCase, kNoCase};
};

struct Plan {
  std::vector<PlannedRow> rows;
  std::vector<Case> cases;
};

GatedShape GatedShapeOf(ShapeKind shape) {
  switch (shape) {
    case ShapeKind::kAabb:
      return GatedShape::kAabb;
    case ShapeKind::kSimplex:
      return GatedShape::kSimplex;
    case ShapeKind::kAabo:
      break;
  }
  return GatedShape::kAabo;
}

std::size_t& Of(PerShape<std::size_t>& values, ShapeKind shape) {
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

std::string CaseName(const CrossoverRow& row, ShapeKind shape) {
  std::string name = "crossover/" + row.working_set + "/" + row.target + "/" +
                     row.schedule + "/";
  if (row.w) name += "w" + std::to_string(*row.w) + "/";
  return name + NameOf(shape);
}

// Adds a row whose cases are made by make_case(name, shape).
template <typename MakeCase>
void AddRow(Plan& plan, CrossoverRow row, const std::vector<ShapeKind>& shapes,
            const MakeCase& make_case) {
  PlannedRow planned{std::move(row), {kNoCase, kNoCase, kNoCase}};
  for (ShapeKind shape : shapes) {
    Of(planned.cases, shape) = plan.cases.size();
    plan.cases.push_back(make_case(CaseName(planned.row, shape), shape));
    // The shapes of one row are compared with each other.
    plan.cases.back().group = std::to_string(plan.rows.size());
  }
  plan.rows.push_back(std::move(planned));
}

Case GatedCase(WorkingSet& set, std::string name, ShapeKind shape,
               Target target, std::size_t width) {
  const GatedScan scan = GatedScanFor(target);
  const std::vector<const float*> planes = PlanesOf(shape, set.view());
  return set.MakeCase(std::move(name), shape,
                      [&set, scan, shape, planes, width](const Aabo3& aabo) {
                        const std::vector<float> query = QueryOf(shape, aabo);
                        scan(GatedShapeOf(shape), width, planes.data(),
                             query.data(), set.objects(), set.mask().data());
                      });
}

// One object after the other, stopping at its first failing plane.
Case ScalarCase(WorkingSet& set, std::string name, ShapeKind shape) {
  return set.MakeCase(std::move(name), shape, [&set, shape](const Aabo3& aabo) {
    WithShape(shape, set.view(), aabo,
              [&set](const auto& view, const auto& query) {
                reference::RejectMask(view, query, set.mask().data());
              });
  });
}

// Every power of two from the lane count on; only the headlines where a scan
// takes long.
std::vector<std::size_t> Widths(std::size_t lanes, bool only_headlines) {
  if (only_headlines) {
    std::vector<std::size_t> headlines = {lanes};
    for (std::size_t w : {std::size_t{64}, kWidestGate}) {
      if (w > lanes) headlines.push_back(w);
    }
    return headlines;
  }
  std::vector<std::size_t> widths;
  for (std::size_t w = lanes; w <= kWidestGate; w *= 2) widths.push_back(w);
  return widths;
}

void PlanTarget(Plan& plan, WorkingSet& set, Target target) {
  const std::vector<ShapeKind> all(kShapes.begin(), kShapes.end());
  const CrossoverRow base{
      std::string(target.name()), target.lanes(), set.name(), "", {}, {}, {}};
  for (std::size_t width : Widths(target.lanes(), set.name() == "memory")) {
    CrossoverRow row = base;
    row.schedule = "every-plane";
    row.w = width;
    AddRow(plan, row, all, [&](std::string name, ShapeKind shape) {
      return GatedCase(set, std::move(name), shape, target, width);
    });
  }
  const auto add = [&](const char* schedule_name, Schedule schedule,
                       const std::vector<ShapeKind>& shapes) {
    CrossoverRow row = base;
    row.schedule = schedule_name;
    AddRow(plan, row, shapes, [&](std::string name, ShapeKind shape) {
      return set.LibraryCase(std::move(name), shape,
                             {.schedule = schedule, .target = target});
    });
  };
  add("flat", Schedule::kFlat, all);
  add("staged", Schedule::kStaged, {ShapeKind::kAabb, ShapeKind::kAabo});
  add("by-axis", Schedule::kStagedByAxis, {ShapeKind::kAabo});
}

void PlanScalar(Plan& plan, WorkingSet& set) {
  CrossoverRow row{"reference", 1, set.name(), "every-plane", 1, {}, {}};
  AddRow(plan, row, {kShapes.begin(), kShapes.end()},
         [&](std::string name, ShapeKind shape) {
           return ScalarCase(set, std::move(name), shape);
         });
}

void FillRow(PlannedRow& planned, const std::vector<Timing>& timings) {
  const auto median = [&](std::size_t i) -> std::optional<double> {
    if (i == kNoCase) return std::nullopt;
    return timings[i].Median();
  };
  CrossoverRow& row = planned.row;
  row.ns = {median(planned.cases.aabb), median(planned.cases.simplex),
            median(planned.cases.aabo)};
  if (row.ns.aabb && row.ns.simplex) {
    row.simplex_over_aabb =
        RatioOf(timings[planned.cases.simplex], timings[planned.cases.aabb]);
  }
}

}  // namespace

WStar FindWStar(const std::vector<CrossoverRow>& gated_rows) {
  WStar result;
  if (gated_rows.empty()) return result;
  const CrossoverRow& first = gated_rows.front();
  result = {first.target, first.lanes, first.working_set, {}, false};
  // From the widest gate down to the narrowest from which on the simplex leads.
  std::size_t lead = gated_rows.size();
  while (lead > 0 && gated_rows[lead - 1].simplex_over_aabb->median <= 1.0) {
    --lead;
  }
  if (lead == gated_rows.size()) return result;
  const double w = static_cast<double>(*gated_rows[lead].w);
  if (lead == 0) {
    result.w_star = w;
    result.is_at_most = true;
    return result;
  }
  // Straight between the two measured ratios, over log2 w.
  const double above = gated_rows[lead - 1].simplex_over_aabb->median - 1.0;
  const double below = 1.0 - gated_rows[lead].simplex_over_aabb->median;
  const double w_before = static_cast<double>(*gated_rows[lead - 1].w);
  result.w_star = w_before * std::pow(w / w_before, above / (above + below));
  return result;
}

CrossoverResult RunCrossover(const std::vector<WorkingSet*>& sets,
                             const Context& context) {
  Plan plan;
  for (WorkingSet* set : sets) {
    PlanScalar(plan, *set);
    for (Target target : context.targets) PlanTarget(plan, *set, target);
  }
  const std::vector<Timing> timings =
      Measure(plan.cases, context.effort, context.progress);
  context.timings.insert(context.timings.end(), timings.begin(), timings.end());
  CrossoverResult result;
  for (PlannedRow& planned : plan.rows) {
    FillRow(planned, timings);
    result.rows.push_back(planned.row);
  }
  for (WorkingSet* set : sets) {
    for (Target target : context.targets) {
      std::vector<CrossoverRow> gated;
      for (const CrossoverRow& row : result.rows) {
        if (row.target == target.name() && row.working_set == set->name() &&
            row.w) {
          gated.push_back(row);
        }
      }
      result.w_stars.push_back(FindWStar(gated));
    }
  }
  return result;
}

}  // namespace halfspace::bench
