#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/baselines/target_loops.h"
#include "bench/sections/throughput.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

// A quantized world of octahedra, larger than the last-level cache.
class QuantizedSet {
 public:
  QuantizedSet(const Workload& workload, std::size_t objects)
      : floats_(ResizedTo(workload.objects, objects)),
        world_(floats_),
        queries_(workload.queries),
        indices_(objects),
        mask_(MaskWords(objects)) {}

  std::size_t objects() const { return world_.size(); }
  const AaboWorld3& floats() const { return floats_; }
  const QuantizedWorld<AaboView3>& world() const { return world_; }

  // The quantized planes in order: all minima, which are the first stage, then
  // all maxima.
  BytePlanes QuantizedPlanes(std::size_t count) const {
    const auto view = world_.quantized().view();
    BytePlanes planes;
    for (std::size_t p = 0; p < count; ++p) {
      planes.push_back(reinterpret_cast<const unsigned char*>(view.planes[p]));
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
          const std::size_t count = Survivors(any, queries_[q], indices_, how);
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

  // Quantized bounds alone, as a mask that keeps all that the floats keep.
  Case QuantizedCase(std::string name, const Options& options) {
    Case c = CaseOf(std::move(name));
    c.run = [this, options, next = std::size_t{0}]() mutable {
      SurvivorMask(world_.quantized(), queries_[next], mask_, options);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    };
    c.check = [this, options]() -> std::string {
      std::vector<std::uint64_t> exact(mask_.size());
      for (std::size_t q = 0; q < Checked(); ++q) {
        SurvivorMask(floats_, queries_[q], exact);
        SurvivorMask(world_.quantized(), queries_[q], mask_, options);
        for (std::size_t w = 0; w < exact.size(); ++w) {
          if ((exact[w] & ~mask_[w]) != 0)
            return "a quantized bound falsely rejects";
        }
      }
      return {};
    };
    return c;
  }

  Case ReadCase(std::string name, std::size_t planes, ReadWay way,
                Target target) {
    Case c = CaseOf(std::move(name));
    c.run = [this, read = LoopsFor(target).read, way,
             list = QuantizedPlanes(planes)] {
      KeepResult(read(way, list.data(), list.size(), objects()));
    };
    return c;
  }

 private:
  static constexpr std::size_t kCheckedQueries = 2;

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
  QuantizedWorld<AaboView3> world_;
  std::vector<Aabo3> queries_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint64_t> mask_;
};

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
  throughput.AddRow(row);
  row.name =
      std::string("AABO floats ") + kSchedules[fastest - 1].name + ", indices";
  row.ns_per_pair = timings[fastest].Median();
  throughput.AddRow(row);
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
  throughput.AddRow(row);
  row.ceiling = row.name;
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
