#include <algorithm>
#include <map>
#include <utility>

#include "bench/baselines/plane_reader.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

struct ScheduleName {
  const char* name;
  Schedule schedule;
};

std::vector<ScheduleName> SchedulesOf(ShapeKind shape) {
  switch (shape) {
    case ShapeKind::kSimplex:
      return {{"flat", Schedule::kFlat}};
    case ShapeKind::kAabb:
      return {{"flat", Schedule::kFlat}, {"staged", Schedule::kStaged}};
    case ShapeKind::kAabo:
      break;
  }
  return {{"flat", Schedule::kFlat},
          {"staged", Schedule::kStaged},
          {"by-axis", Schedule::kStagedByAxis}};
}

// Reading the planes of one shape, per object.
Case ReadCase(WorkingSet& set, ShapeKind shape, ReadWay way) {
  const PlaneReader read = PlaneReaderFor(SupportedTargets().front());
  const std::size_t rounds =
      std::max<std::size_t>(1, kObjectsPerRun / set.objects());
  Case c;
  c.name = "read/" + set.name() + "/" + NameOf(shape) + "/" +
           std::string(NameOf(way));
  c.items = static_cast<double>(set.objects() * rounds);
  c.run = [read, way, planes = BytesOf(PlanesOf(shape, set.view())),
           bytes = set.objects() * sizeof(float), rounds] {
    for (std::size_t i = 0; i < rounds; ++i) {
      KeepResult(read(way, planes.data(), planes.size(), bytes));
    }
  };
  return c;
}

struct PlannedRow {
  KernelRow row;
  std::size_t case_index;
  std::size_t planes;
};

}  // namespace

KernelsResult RunKernels(const std::vector<WorkingSet*>& sets,
                         const Context& context) {
  std::vector<Case> cases;
  std::vector<PlannedRow> plan;
  // Per working set and shape, the cases of the readers.
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> reads;
  for (WorkingSet* set : sets) {
    for (ShapeKind shape : kShapes) {
      for (ReadWay way : {ReadWay::kByWord, ReadWay::kByPlane}) {
        reads[{set->name(), NameOf(shape)}].push_back(cases.size());
        cases.push_back(ReadCase(*set, shape, way));
        cases.back().group = set->name();
      }
      for (Target target : context.targets) {
        for (const ScheduleName& schedule : SchedulesOf(shape)) {
          KernelRow row;
          row.shape = NameOf(shape);
          row.target = target.name();
          row.schedule = schedule.name;
          row.working_set = set->name();
          row.objects = set->objects();
          const std::string name = "kernels/" + row.working_set + "/" +
                                   row.target + "/" + row.shape + "/" +
                                   row.schedule;
          plan.push_back(
              {row, cases.size(), PlanesOf(shape, set->view()).size()});
          cases.push_back(set->LibraryCase(
              name, shape, {.schedule = schedule.schedule, .target = target}));
          cases.back().group = set->name();
        }
      }
    }
  }
  const std::vector<Timing> timings =
      Measure(cases, context.effort, context.progress);
  context.timings.insert(context.timings.end(), timings.begin(), timings.end());
  KernelsResult result;
  for (const PlannedRow& planned : plan) {
    KernelRow row = planned.row;
    const Timing& timing = timings[planned.case_index];
    row.ns_per_object = timing.Median();
    row.gigabytes_per_second =
        static_cast<double>(planned.planes * sizeof(float)) / row.ns_per_object;
    // The faster reader is the ceiling.
    for (std::size_t read : reads[{row.working_set, row.shape}]) {
      const Ratio percent = RatioOf(timings[read], timing).Percent();
      if (row.percent_of_read.median == 0.0 ||
          percent.median < row.percent_of_read.median) {
        row.percent_of_read = percent;
      }
    }
    result.rows.push_back(row);
  }
  return result;
}

}  // namespace halfspace::bench
