#include <algorithm>
#include <string>
#include <utility>

#include "bench/baselines/plane_reader.h"
#include "bench/baselines/register_scan.h"
#include "bench/sections/throughput.h"

namespace halfspace::bench {
namespace {

std::string RatioName(const std::string& what, ShapeKind shape,
                      const std::string& set, Target target) {
  return std::string(NameOf(shape)) + " flat, " + set + ", " + NameOf(target) +
         ": % of " + what;
}

// one shape and target: the flat kernel and every reader.
void RunAgainstReading(WorkingSet& set, ShapeKind shape, Target target,
                       Throughput& throughput) {
  const std::string place =
      set.name() + "/" + NameOf(target) + "/" + NameOf(shape);
  std::vector<Case> cases = {set.LibraryCase(
      "flat/" + place, shape, {.schedule = Schedule::kFlat, .target = target})};
  std::vector<std::size_t> readers;
  for (ReadWay way : kReadWays) {
    readers.push_back(cases.size());
    cases.push_back(
        set.ReadCase("read/" + place + "/" + NameOf(way), shape, way, target));
  }
  const Timings timings = throughput.Time(std::move(cases));
  const std::size_t fastest = FastestOf(timings, readers);
  ThroughputRow row;
  row.objects = set.objects();
  row.queries = 1;
  row.working_set = set.name();
  row.target = NameOf(target);
  row.name = std::string("read ") + NameOf(shape) + " " +
             NameOf(kReadWays[fastest - readers.front()]);
  row.ns_per_pair = timings[fastest].Median();
  row.ceiling = throughput.AddCeiling(
      {Ceiling::Kind::kRead, shape, set.name(), target}, row);
  const Ratio percent = RatioOf(timings[fastest], timings[0]).Percent();
  row.name = std::string(NameOf(shape)) + " flat";
  row.ns_per_pair = timings[0].Median();
  row.percent_of_ceiling = percent.median;
  throughput.AddRow(row);
  throughput.AddRatio(aims::kReading, target,
                      RatioName("the fastest read", shape, set.name(), target),
                      percent);
}

// one shape and target: many queries a call, so that what a call
// costs by itself (threshold 7) is not in it.
void RunAgainstRegisters(InCache& world, Target target,
                         Throughput& throughput) {
  const RegisterScan scan = RegisterScansFor(target).many;
  if (scan == nullptr) {
    throughput.NotReached("" + NameOf(target) +
                          ": no compare of registers alone");
    return;
  }
  const ShapeKind shape = world.shape();
  const std::string place = "L1/" + NameOf(target) + "/" + NameOf(shape);
  Case registers;
  registers.name = "registers/" + place;
  registers.items = world.items();
  registers.run = [&world, scan, planes = PlanesOf(world.shape(), world.view()),
                   query = QueryOf(world.shape(), world.queries().aabos()[0])] {
    for (std::size_t i = 0; i < world.rounds() * world.queries().size(); ++i) {
      scan(world.shape(), planes.data(), query.data(), world.view().size,
           world.rows().data());
    }
  };
  const Timings timings = throughput.Time(
      {world.MasksCase("flat-many/" + place, target), std::move(registers)});
  ThroughputRow row;
  row.objects = world.view().size;
  row.queries = world.queries().size();
  row.working_set = "L1";
  row.target = NameOf(target);
  row.name = std::string("registers ") + NameOf(shape);
  row.ns_per_pair = timings[1].Median();
  row.ceiling = throughput.AddCeiling(
      {Ceiling::Kind::kRegisters, shape, row.working_set, target}, row);
  row.name = std::string(NameOf(shape)) + " flat, masks of many";
  row.ns_per_pair = timings[0].Median();
  const Ratio percent = RatioOf(timings[1], timings[0]).Percent();
  row.percent_of_ceiling = percent.median;
  throughput.AddRatio(aims::kRegisters, target,
                      RatioName("registers, many queries", shape, "L1", target),
                      percent);
  throughput.AddRow(row);
}

}  // namespace

void AddCeilingParts(const Workload& workload, const Machine& machine,
                     const std::vector<WorkingSet*>& sets,
                     ThroughputParts& parts) {
  for (WorkingSet* set : sets) {
    for (ShapeKind shape : kShapes) {
      parts.push_back([set, shape](Throughput& throughput) {
        for (Target target : throughput.targets()) {
          RunAgainstReading(*set, shape, target, throughput);
        }
      });
    }
  }
  parts.push_back([&workload, &machine](Throughput& throughput) {
    for (ShapeKind shape : kShapes) {
      InCache world(workload, machine, shape);
      for (Target target : throughput.targets()) {
        RunAgainstRegisters(world, target, throughput);
      }
    }
  });
}

}  // namespace halfspace::bench
