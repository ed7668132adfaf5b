#include <array>
#include <optional>
#include <utility>

#include "bench/base/schedules.h"
#include "bench/baselines/gated_scan.h"
#include "bench/measure/cost_model.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

std::string CaseName(const CrossoverRow& row, ShapeKind shape) {
  std::string name = "crossover/" + row.working_set + "/" + row.target + "/" +
                     row.schedule + "/";
  if (row.w) name += "w" + std::to_string(*row.w) + "/";
  return name + NameOf(shape);
}

// Adds a row whose cases are made by make_case(name, shape).
template <typename MakeCase>
void AddRow(Plan<CrossoverRow>& plan, const CrossoverRow& row,
            const std::vector<ShapeKind>& shapes, const MakeCase& make_case) {
  std::array<std::optional<std::size_t>, kShapes.size()> places;
  for (ShapeKind shape : shapes) {
    Case c = make_case(CaseName(row, shape), shape);
    // The shapes of one row are compared with each other.
    c.group = std::to_string(plan.rows());
    places[static_cast<std::size_t>(shape)] = plan.AddCase(std::move(c));
  }
  plan.AddRow(row, [places](const Timings& timings, CrossoverRow& timed) {
    const auto timing = [&](ShapeKind shape) -> const Timing* {
      const auto place = places[static_cast<std::size_t>(shape)];
      return place ? &timings[*place] : nullptr;
    };
    const auto median = [&](ShapeKind shape) -> std::optional<double> {
      if (!timing(shape)) return std::nullopt;
      return timing(shape)->Median();
    };
    timed.ns = {median(ShapeKind::kAabb), median(ShapeKind::kSimplex),
                median(ShapeKind::kAabo)};
    if (timed.ns.aabb && timed.ns.simplex) {
      timed.simplex_over_aabb =
          RatioOf(*timing(ShapeKind::kSimplex), *timing(ShapeKind::kAabb));
    }
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

void PlanTarget(Plan<CrossoverRow>& plan, WorkingSet& set, Target target) {
  const std::vector<ShapeKind> all(kShapes.begin(), kShapes.end());
  const CrossoverRow base{
      std::string(target.name()), target.lanes(), set.name(), "", {}, {}, {}};
  for (std::size_t width : Widths(target.lanes(), set.name() == "memory")) {
    CrossoverRow row = base;
    row.schedule = "every-plane";
    row.w = width;
    AddRow(plan, row, all, [&](std::string name, ShapeKind shape) {
      return set.GatedCase(std::move(name), shape, target, width);
    });
  }
  for (std::size_t s = 0; s < kSchedules.size(); ++s) {
    CrossoverRow row = base;
    row.schedule = kSchedules[s].name;
    std::vector<ShapeKind> shapes;
    for (ShapeKind shape : kShapes) {
      if (s < SchedulesOf(shape).size()) shapes.push_back(shape);
    }
    AddRow(plan, row, shapes, [&](std::string name, ShapeKind shape) {
      return set.LibraryCase(
          std::move(name), shape,
          {.schedule = kSchedules[s].schedule, .target = target});
    });
  }
}

void PlanScalar(Plan<CrossoverRow>& plan, WorkingSet& set) {
  CrossoverRow row{"reference", 1, set.name(), "every-plane", 1, {}, {}};
  AddRow(plan, row, {kShapes.begin(), kShapes.end()},
         [&](std::string name, ShapeKind shape) {
           return ScalarCase(set, std::move(name), shape);
         });
}

}  // namespace

WStar FindWStar(const std::vector<CrossoverRow>& gated_rows) {
  WStar result;
  if (gated_rows.empty()) return result;
  const CrossoverRow& first = gated_rows.front();
  result.target = first.target;
  result.lanes = first.lanes;
  result.working_set = first.working_set;
  const auto lead_by = [&gated_rows](double Ratio::*figure) {
    std::vector<double> widths;
    std::vector<double> ratios;
    for (const CrossoverRow& row : gated_rows) {
      widths.push_back(static_cast<double>(*row.w));
      ratios.push_back((*row.simplex_over_aabb).*figure);
    }
    return FindLead(widths, ratios);
  };
  const LeadFrom lead = lead_by(&Ratio::median);
  result.w_star = lead.w;
  result.is_at_most = lead.is_at_most;
  result.low = lead_by(&Ratio::low).w;
  result.high = lead_by(&Ratio::high).w;
  return result;
}

CrossoverResult RunCrossover(const std::vector<WorkingSet*>& sets,
                             const Context& context) {
  Plan<CrossoverRow> plan;
  for (WorkingSet* set : sets) {
    PlanScalar(plan, *set);
    for (Target target : context.targets) PlanTarget(plan, *set, target);
  }
  CrossoverResult result;
  plan.Run(context.effort, context, result.rows);
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
