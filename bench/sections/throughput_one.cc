#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/curves.h"
#include "bench/sections/throughput.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

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
  throughput.AddRow(row);
  row.ceiling = row.name;
  const Ratio percent = RatioOf(timings[fastest], timings[0]).Percent();
  row.name = std::string(NameOf(shape)) + " flat";
  row.ns_per_pair = timings[0].Median();
  row.percent_of_ceiling = percent.median;
  throughput.AddRow(row);
  throughput.AddRatio(aims::kReading, target,
                      std::string(NameOf(shape)) + " flat, " + set.name() +
                          ", " + NameOf(target) + ": % of the fastest read",
                      percent);
}

constexpr std::array<std::size_t, 7> kSizes = {64,  128, 256, 384,
                                               512, 768, 1024};

// One flat call after the other on the first objects of a world. The view and
// the queries are of that shape beforehand, as a user's are.
Case CallCase(std::string name, const Workload& workload,
              const AaboWorld3& world, ShapeKind shape, std::size_t objects,
              Target target) {
  const std::size_t calls = kObjectsPerRun / objects;
  AaboView3 first = world.view();
  first.size = objects;
  Case c;
  c.name = std::move(name);
  c.items = static_cast<double>(calls);
  WithShape(shape, first, workload.queries.front(),
            [&]<typename Query>(const auto& view, const Query& /*query*/) {
              std::vector<Query> queries;
              for (const Aabo3& query : workload.queries) {
                queries.push_back(SeenAs<Query>(query));
              }
              c.run = [=, mask = std::vector<std::uint64_t>(MaskWords(objects)),
                       next = std::size_t{0}]() mutable {
                for (std::size_t i = 0; i < calls; ++i) {
                  RejectMask(view, queries[next], mask,
                             {.schedule = Schedule::kFlat, .target = target});
                  next = next + 1 == queries.size() ? 0 : next + 1;
                }
              };
            });
  return c;
}

}  // namespace

void AddCeilingParts(const std::vector<WorkingSet*>& sets,
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
}

void AddCallParts(const Workload& workload, ThroughputParts& parts) {
  parts.push_back([&workload](Throughput& throughput) {
    const AaboWorld3 world = ResizedTo(workload.objects, kSizes.back());
    for (Target target : throughput.targets()) {
      for (ShapeKind shape : kShapes) {
        const std::string name = NameOf(target) + "/" + NameOf(shape);
        std::vector<Case> cases;
        cases.reserve(kSizes.size());
        for (std::size_t objects : kSizes) {
          cases.push_back(
              CallCase("call/" + name + "/" + std::to_string(objects), workload,
                       world, shape, objects, target));
        }
        std::vector<double> sizes(kSizes.begin(), kSizes.end());
        std::vector<double> times;
        for (const Timing& timing : throughput.TimeBriefly(std::move(cases))) {
          times.push_back(timing.Median());
        }
        throughput.AddRatio(aims::kCall, target,
                            "ns of a call by itself, " +
                                std::string(NameOf(shape)) + " flat, " +
                                NameOf(target),
                            FitLine(sizes, times).intercept);
      }
    }
  });
}

}  // namespace halfspace::bench
