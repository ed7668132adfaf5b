#include <string>
#include <utility>
#include <vector>

#include "bench/base/schedules.h"
#include "bench/baselines/plane_reader.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

// The readers of one shape's planes, and every target and schedule.
void PlanShape(Plan<KernelRow>& plan, WorkingSet& set, ShapeKind shape,
               const std::vector<Target>& targets) {
  const auto add = [&](Case c) {
    c.group = set.name();
    return plan.AddCase(std::move(c));
  };
  std::vector<std::size_t> reads;
  for (ReadWay way : {ReadWay::kByWord, ReadWay::kByPlane}) {
    reads.push_back(add(set.ReadCase(
        "read/" + set.name() + "/" + NameOf(shape) + "/" + NameOf(way), shape,
        way, SupportedTargets().front())));
  }
  const double bytes = static_cast<double>(PlaneCountOf(shape) * sizeof(float));
  for (Target target : targets) {
    for (const NamedSchedule& schedule : SchedulesOf(shape)) {
      KernelRow row;
      row.shape = NameOf(shape);
      row.target = target.name();
      row.schedule = schedule.name;
      row.working_set = set.name();
      row.objects = set.objects();
      const std::size_t place = add(set.LibraryCase(
          "kernels/" + row.working_set + "/" + row.target + "/" + row.shape +
              "/" + row.schedule,
          shape, {.schedule = schedule.schedule, .target = target}));
      plan.AddRow(std::move(row),
                  [=](const Timings& timings, KernelRow& timed) {
                    timed.ns_per_object = timings[place].Median();
                    timed.low = timings[place].Quantile(0.25);
                    timed.high = timings[place].Quantile(0.75);
                    timed.gigabytes_per_second = bytes / timed.ns_per_object;
                    // The faster reader is the ceiling.
                    for (std::size_t read : reads) {
                      const Ratio percent =
                          RatioOf(timings[read], timings[place]).Percent();
                      if (timed.percent_of_read.median == 0.0 ||
                          percent.median < timed.percent_of_read.median) {
                        timed.percent_of_read = percent;
                      }
                    }
                  });
    }
  }
}

}  // namespace

KernelsResult RunKernels(const std::vector<WorkingSet*>& sets,
                         const Context& context) {
  Plan<KernelRow> plan;
  for (WorkingSet* set : sets) {
    for (ShapeKind shape : kShapes) {
      PlanShape(plan, *set, shape, context.targets);
    }
  }
  KernelsResult result;
  plan.Run(context.effort, context, result.rows);
  return result;
}

}  // namespace halfspace::bench
