#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "bench/plane_reader.h"
#include "bench/throughput.h"
#include "halfspace/codes.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kStagePlanes = 4;
constexpr std::size_t kPlanes = 8;
constexpr std::size_t kCheckedQueries = 2;

// So many that the codes of the first stage alone, 4 bytes an object, take four
// times the last level; fewer, if that needs too much memory.
std::size_t ObjectsOf(const Machine& machine, bool is_quick) {
  constexpr std::size_t kStep = 4096;
  constexpr std::size_t kBytes = 32 + 8;
  std::size_t objects = machine.LastLevelBytes() / (is_quick ? 2 : 1);
  if (machine.available_memory != 0) {
    objects = std::min(objects, machine.available_memory / 4 / kBytes);
  }
  return objects / kStep * kStep;
}

// A coded world of octahedra, out of the last level.
class CodedSet {
 public:
  CodedSet(const Workload& workload, std::size_t objects)
      : floats_(ResizedTo(workload.objects, objects)),
        world_(floats_),
        queries_(workload.queries),
        indices_(objects),
        mask_(MaskWords(objects)) {}

  std::size_t objects() const { return world_.size(); }
  const AaboWorld3& floats() const { return floats_; }
  const CodedWorld<AaboView3>& world() const { return world_; }

  // The planes of codes in order: all minima, which are the first stage, then
  // all maxima.
  BytePlanes CodePlanes(std::size_t count) const {
    const auto view = world_.codes().view();
    BytePlanes planes;
    for (std::size_t p = 0; p < count; ++p) {
      planes.push_back(reinterpret_cast<const unsigned char*>(
          view.planes().planes().plane(p)));
    }
    return planes;
  }

  // Survivors as indices, checked against those of the floats.
  template <typename AnyWorld>
  Case IndicesCase(std::string name, const AnyWorld& world,
                   const Options& options) {
    Case c = CaseOf(std::move(name));
    c.run = [this, &world, options, next = std::size_t{0}]() mutable {
      std::ignore = Survivors(world, queries_[next], indices_, options);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    };
    c.check = [this, &world, options]() -> std::string {
      for (std::size_t q = 0; q < Checked(); ++q) {
        const auto list = [&](const auto& any, const Options& how) {
          indices_.resize(objects());
          const std::size_t count =
              Survivors(any, queries_[q], indices_, how).count;
          return std::vector<std::uint32_t>(
              indices_.begin(),
              indices_.begin() + static_cast<std::ptrdiff_t>(count));
        };
        if (list(world, options) !=
            list(floats_, {.schedule = Schedule::kFlat})) {
          return "query " + std::to_string(q) +
                 ": the survivors are not those of the floats";
        }
      }
      return {};
    };
    return c;
  }

  // Codes alone, as a mask that keeps all that the floats keep.
  Case CodesCase(std::string name, const Options& options) {
    Case c = CaseOf(std::move(name));
    c.run = [this, options, next = std::size_t{0}]() mutable {
      SurvivorMask(world_.codes(), queries_[next], mask_, options);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    };
    c.check = [this, options]() -> std::string {
      std::vector<std::uint64_t> exact(mask_.size());
      for (std::size_t q = 0; q < Checked(); ++q) {
        SurvivorMask(floats_, queries_[q], exact);
        SurvivorMask(world_.codes(), queries_[q], mask_, options);
        for (std::size_t w = 0; w < exact.size(); ++w) {
          if ((exact[w] & ~mask_[w]) != 0) return "a code falsely rejects";
        }
      }
      return {};
    };
    return c;
  }

  Case ReadCase(std::string name, std::size_t planes, ReadWay way,
                Target target) {
    Case c = CaseOf(std::move(name));
    c.run = [this, read = PlaneReaderFor(target), way,
             list = CodePlanes(planes)] {
      KeepResult(read(way, list.data(), list.size(), objects()));
    };
    return c;
  }

 private:
  Case CaseOf(std::string name) const {
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(objects());
    return c;
  }
  std::size_t Checked() const {
    return std::min(kCheckedQueries, queries_.size());
  }

  AaboWorld3 floats_;
  CodedWorld<AaboView3> world_;
  std::vector<Aabo3> queries_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint64_t> mask_;
};

struct ScheduleName {
  const char* name;
  Schedule schedule;
};
constexpr ScheduleName kSchedules[] = {{"flat", Schedule::kFlat},
                                       {"staged", Schedule::kStaged},
                                       {"by-axis", Schedule::kStagedByAxis}};

// What the code scan is measured by.
struct Reading {
  const char* name;
  Schedule schedule;
  std::size_t planes;
};
constexpr Reading kReadings[] = {
    {"staged, of the 4 planes of the first stage", Schedule::kStaged,
     kStagePlanes},
    {"flat, of all 8 planes", Schedule::kFlat, kPlanes}};

ThroughputRow RowOf(const CodedSet& set, Target target) {
  ThroughputRow row;
  row.objects = set.objects();
  row.queries = 1;
  row.working_set = "memory";
  row.target = target.name();
  return row;
}

void RunConfirmed(CodedSet& set, Target target, Throughput& throughput) {
  const std::string name(target.name());
  std::vector<Case> cases = {set.IndicesCase("confirmed/memory/" + name,
                                             set.world(), {.target = target})};
  std::vector<std::size_t> floats;
  for (const ScheduleName& schedule : kSchedules) {
    floats.push_back(cases.size());
    cases.push_back(set.IndicesCase(
        "floats/memory/" + name + "/" + schedule.name, set.floats(),
        {.schedule = schedule.schedule, .target = target}));
  }
  const Timings timings = throughput.TimeLong(std::move(cases));
  const std::size_t fastest = FastestOf(timings, floats);
  ThroughputRow row = RowOf(set, target);
  row.name = "aabo uint8 confirmed, indices";
  row.ns_per_pair = timings[0].Median();
  throughput.AddRowUnder("read codes 4-planes", row.working_set, row);
  row.name =
      std::string("aabo floats ") + kSchedules[fastest - 1].name + ", indices";
  row.ns_per_pair = timings[fastest].Median();
  throughput.AddRowUnder("read simplex", row.working_set, row);
  throughput.AddAtLeast(4,
                        "aabo uint8 confirmed, one query, memory, " + name +
                            ": times the fastest of floats",
                        RatioOf(timings[fastest], timings[0]).median, 3.5);
}

void RunCodeScan(CodedSet& set, const Reading& reading, Target target,
                 Throughput& throughput) {
  const std::string name(target.name());
  const std::string planes = std::to_string(reading.planes) + "-planes";
  std::vector<Case> cases = {
      set.CodesCase("codes/memory/" + name + "/" + planes,
                    {.schedule = reading.schedule, .target = target})};
  std::vector<std::size_t> readers;
  for (ReadWay way : kReadWays) {
    readers.push_back(cases.size());
    cases.push_back(set.ReadCase(
        "read-codes/memory/" + name + "/" + planes + "/" + NameOf(way),
        reading.planes, way, target));
  }
  const Timings timings = throughput.TimeLong(std::move(cases));
  const std::size_t fastest = FastestOf(timings, readers);
  ThroughputRow row = RowOf(set, target);
  row.name = "read codes " + planes + " " +
             NameOf(kReadWays[fastest - readers.front()]);
  row.ns_per_pair = timings[fastest].Median();
  throughput.AddRow(row);
  row.ceiling = row.name;
  row.name = std::string("aabo uint8 codes alone, ") + reading.name;
  row.ns_per_pair = timings[0].Median();
  row.percent_of_ceiling = 100.0 * RatioOf(timings[fastest], timings[0]).median;
  throughput.AddAtLeast(4,
                        std::string("code scan, one query, memory, ") + name +
                            ": % of the fastest read, " + reading.name,
                        *row.percent_of_ceiling, 90.0);
  throughput.AddRow(row);
}

}  // namespace

void AddCodedParts(const Workload& workload, const Machine& machine,
                   bool is_quick, ThroughputParts& parts) {
  const std::size_t objects = ObjectsOf(machine, is_quick);
  const bool is_reached =
      !machine.is_emulated && objects * kPlanes >= 4 * machine.LastLevelBytes();
  if (!is_reached) {
    parts.push_back([](Throughput& throughput) {
      throughput.NotReached(
          "bar 4, one query: codes of four times the last level take more than "
          "a quarter of the free memory, or the CPU is emulated");
    });
    return;
  }
  auto shared = std::make_shared<std::unique_ptr<CodedSet>>();
  parts.push_back([shared, &workload, objects](Throughput& throughput) {
    *shared = std::make_unique<CodedSet>(workload, objects);
    for (Target target : throughput.targets()) {
      for (const Reading& reading : kReadings) {
        RunCodeScan(**shared, reading, target, throughput);
      }
    }
  });
  parts.push_back([shared](Throughput& throughput) {
    for (Target target : throughput.targets()) {
      RunConfirmed(**shared, target, throughput);
    }
  });
}

}  // namespace halfspace::bench
