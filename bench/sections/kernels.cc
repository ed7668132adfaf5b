// Every shape, target, schedule and working set, against reading the planes.
#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {
namespace {

void AddRows(Run& run, WorkingSet& set, ShapeKind shape, Table& table) {
  const std::string place = set.name() + "/" + NameOf(shape) + "/";
  std::vector<Case> cases;
  // By words as a kernel, by pages, and by planes, with vectors of the two
  // greatest widths: which is fastest depends on the cache and its prefetchers.
  const std::span<const Target> targets = SupportedTargets();
  for (Target target :
       targets.first(std::min<std::size_t>(2, targets.size()))) {
    for (std::size_t turn :
         {kReadBytes, std::size_t{4096}, set.objects() * sizeof(float)}) {
      cases.push_back(set.ReadCase(
          "read/" + place + NameOf(target) + "/" + std::to_string(turn), shape,
          turn, target));
    }
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
  // The fastest reader is the ceiling.
  const Timing& read = *std::min_element(
      timings.begin(), timings.begin() + static_cast<std::ptrdiff_t>(reads),
      [](const Timing& a, const Timing& b) { return a.Median() < b.Median(); });
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
