#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "bench/base/schedules.h"
#include "bench/baselines/plane_reader.h"
#include "bench/sections/throughput.h"
#include "bench/worlds/quantized_set.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

// So many that the planes of the first stage alone, 4 bytes an object, take
// four times the last-level cache; fewer, if that needs too much memory.
std::size_t ObjectsOf(const Machine& machine, bool is_quick) {
  constexpr std::size_t kStep = 4096;
  constexpr std::size_t kBytes = 32 + 8;
  std::size_t objects = machine.LastLevelBytes() / (is_quick ? 2 : 1);
  if (machine.available_memory != 0) {
    objects = std::min(objects, machine.available_memory / 4 / kBytes);
  }
  return objects / kStep * kStep;
}

// What a scan of quantized bounds alone is measured by.
struct Reading {
  const char* name;
  Schedule schedule;
  ShapeKind shape;
};
constexpr Reading kReadings[] = {
    {"staged, of the 4 planes of the first stage", Schedule::kStaged,
     ShapeKind::kSimplex},
    {"flat, of all 8 planes", Schedule::kFlat, ShapeKind::kAabo}};

ThroughputRow RowOf(const QuantizedSet& set, Target target) {
  ThroughputRow row;
  row.objects = set.objects();
  row.queries = 1;
  row.working_set = "memory";
  row.target = NameOf(target);
  return row;
}

void RunRefined(QuantizedSet& set, Target target, Throughput& throughput) {
  const std::string name = NameOf(target);
  std::vector<Case> cases = {set.IndicesCase("refined/memory/" + name,
                                             set.world(), {.target = target})};
  std::vector<std::size_t> floats;
  for (const NamedSchedule& schedule : kSchedules) {
    floats.push_back(cases.size());
    cases.push_back(set.IndicesCase(
        "floats/memory/" + name + "/" + schedule.name, set.floats(),
        {.schedule = schedule.schedule, .target = target}));
  }
  const Timings timings = throughput.TimeLong(std::move(cases));
  const std::size_t fastest = FastestOf(timings, floats);
  ThroughputRow row = RowOf(set, target);
  row.name = "AABO uint8 refined, indices";
  row.ns_per_pair = timings[0].Median();
  throughput.AddRowUnder({Ceiling::Kind::kReadQuantized, ShapeKind::kSimplex,
                          row.working_set, target},
                         row);
  row.name =
      std::string("AABO floats ") + kSchedules[fastest - 1].name + ", indices";
  row.ns_per_pair = timings[fastest].Median();
  throughput.AddRowUnder(
      {Ceiling::Kind::kRead, ShapeKind::kSimplex, row.working_set, target},
      row);
  throughput.AddRatio(aims::kFilterOverFloats, target,
                      "AABO uint8 refined, one query, memory, " + name +
                          ": times the fastest of floats",
                      RatioOf(timings[fastest], timings[0]));
}

void RunQuantizedScan(QuantizedSet& set, const Reading& reading, Target target,
                      Throughput& throughput) {
  const std::string name = NameOf(target);
  const std::size_t count = PlaneCountOf(reading.shape);
  const std::string planes = std::to_string(count) + "-planes";
  std::vector<Case> cases = {
      set.QuantizedCase("quantized/memory/" + name + "/" + planes,
                        {.schedule = reading.schedule, .target = target})};
  std::vector<std::size_t> readers;
  for (ReadWay way : kReadWays) {
    readers.push_back(cases.size());
    cases.push_back(set.ReadCase(
        "read-quantized/memory/" + name + "/" + planes + "/" + NameOf(way),
        count, way, target));
  }
  const Timings timings = throughput.TimeLong(std::move(cases));
  const std::size_t fastest = FastestOf(timings, readers);
  ThroughputRow row = RowOf(set, target);
  row.name = "read quantized " + planes + " " +
             NameOf(kReadWays[fastest - readers.front()]);
  row.ns_per_pair = timings[fastest].Median();
  row.ceiling = throughput.AddCeiling(
      {Ceiling::Kind::kReadQuantized, reading.shape, row.working_set, target},
      row);
  row.name = std::string("AABO uint8 quantized alone, ") + reading.name;
  row.ns_per_pair = timings[0].Median();
  const Ratio percent = RatioOf(timings[fastest], timings[0]).Percent();
  row.percent_of_ceiling = percent.median;
  throughput.AddRatio(aims::kReadingQuantized, target,
                      std::string("quantized scan, one query, memory, ") +
                          name + ": % of the fastest read, " + reading.name,
                      percent);
  throughput.AddRow(row);
}

}  // namespace

void AddQuantizedParts(const Workload& workload, const Machine& machine,
                       bool is_quick, ThroughputParts& parts) {
  const std::size_t objects = ObjectsOf(machine, is_quick);
  const bool is_reached =
      !machine.is_emulated &&
      objects * PlaneCountOf(ShapeKind::kAabo) >= 4 * machine.LastLevelBytes();
  if (!is_reached) {
    parts.push_back([](Throughput& throughput) {
      throughput.NotReached(
          "one query: quantized bounds of four times the "
          "last-level cache take "
          "more than "
          "a quarter of the free memory, or the CPU is emulated");
    });
    return;
  }
  auto shared = std::make_shared<std::unique_ptr<QuantizedSet>>();
  parts.push_back([shared, &workload, objects](Throughput& throughput) {
    *shared = std::make_unique<QuantizedSet>(workload, objects);
    for (Target target : throughput.targets()) {
      for (const Reading& reading : kReadings) {
        RunQuantizedScan(**shared, reading, target, throughput);
      }
    }
  });
  parts.push_back([shared](Throughput& throughput) {
    for (Target target : throughput.targets()) {
      RunRefined(**shared, target, throughput);
    }
  });
}

}  // namespace halfspace::bench
