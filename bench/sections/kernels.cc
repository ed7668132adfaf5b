// Every shape, target, schedule and working set, against reading the planes.
#include <string>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

void AddRows(Run& run, WorkingSet& set, ShapeKind shape, Table& table) {
  const std::string place = set.name() + "/" + NameOf(shape) + "/";
  std::vector<Case> cases;
  for (bool by_plane : {false, true}) {
    cases.push_back(
        set.ReadCase("read/" + place + (by_plane ? "by plane" : "by word"),
                     shape, by_plane, SupportedTargets().front()));
  }
  const std::size_t reads = cases.size();
  std::vector<Row> rows;
  for (Target target : run.targets) {
    for (const NamedSchedule& schedule : SchedulesOf(shape)) {
      rows.push_back({NameOf(shape), set.name(), NameOf(target), schedule.name,
                      set.objects()});
      cases.push_back(set.LibraryCase(
          "kernels/" + place + NameOf(target) + "/" + schedule.name, shape,
          {.schedule = schedule.schedule, .target = target}));
    }
  }
  const std::vector<Timing> timings = run.Time(cases);
  const double bytes = static_cast<double>(PlaneCountOf(shape) * sizeof(float));
  // The faster reader is the ceiling.
  const Timing& read =
      timings[timings[0].Median() < timings[1].Median() ? 0 : 1];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Timing& timing = timings[reads + i];
    rows[i].push_back(SpreadOf(timing));
    rows[i].push_back(bytes / timing.Median());
    rows[i].push_back(RatioOf(read, timing).Percent());
    table.Add(rows[i]);
  }
}

}  // namespace

Tables RunKernels(Run& run) {
  Table table{"kernels",
              "one query, by working set",
              {Key("shape"), Key("set"), Key("target"), Key("schedule"),
               Key("objects"), Value("ns/object", "", 4), Value("GB/s", "", 1),
               Higher("% of reading", "", 0)}};
  for (WorkingSet* set : run.Sets({"L1", "L2", "L3", "memory"})) {
    for (ShapeKind shape : kShapes) AddRows(run, *set, shape, table);
  }
  table.notes = run.NotReached();
  return {table};
}

}  // namespace halfspace::bench
