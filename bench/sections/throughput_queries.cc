#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/baselines/gated_scan.h"
#include "bench/measure/queries_in_turn.h"
#include "bench/sections/throughput.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

constexpr std::array<std::size_t, 3> kSizes = {1024, 4096, 16384};
constexpr std::size_t kGate = 64;

// Worlds in the caches, where the branches of a call are what it has to wait
// for.
class SmallWorld {
 public:
  SmallWorld(const Workload& workload, std::size_t objects, Target target)
      : target_(target),
        queries_(workload.timed_queries),
        floats_(ResizedTo(workload.objects, objects)),
        quantized_world_(floats_),
        mask_(MaskWords(objects)),
        indices_(objects) {}

  void Run(Throughput& throughput) {
    AddMask("AABB flat, mask", ShapeKind::kAabb, Schedule::kFlat);
    AddMask("AABB by-axis, mask", ShapeKind::kAabb, Schedule::kStagedByAxis);
    AddMask("AABO staged, mask", ShapeKind::kAabo, Schedule::kStaged);
    AddMask("AABO by-axis, mask", ShapeKind::kAabo, Schedule::kStagedByAxis);
    if (size() % kWidestGate == 0) AddGated();
    Add("AABB one object at a time, mask", [this](const Aabo3& query) {
      reference::RejectMask(floats_.view().aabb(), query.aabb(), mask_.data());
    });
    AddOutputs("AABO floats", floats_);
    AddOutputs("AABO uint8 refined", quantized_world_);
    const Timings timings = throughput.TimeBriefly(std::move(cases_));
    for (std::size_t i = 0; i < names_.size(); ++i) {
      ThroughputRow row;
      row.name = names_[i];
      row.objects = size();
      row.queries = 1;
      row.working_set = "in turn";
      row.target = NameOf(target_);
      throughput.AddRowsInTurn(row, timings[2 * i], timings[2 * i + 1],
                               Throughput::Few::kIfTheyDiffer);
    }
  }

 private:
  std::size_t size() const { return floats_.size(); }
  Options How(Schedule schedule) const {
    return {.schedule = schedule, .target = target_};
  }

  template <typename Call>
  void Add(const std::string& name, const Call& call) {
    const std::string place = "in-turn/" + NameOf(target_) + "/" + name + "/" +
                              std::to_string(size());
    for (std::size_t different : {queries_.size(), kFewQueries}) {
      cases_.push_back(InTurn(place, queries_, different,
                              std::max<std::size_t>(1, kObjectsPerRun / size()),
                              call));
    }
    names_.push_back(name);
  }

  void AddMask(const std::string& name, ShapeKind shape, Schedule schedule) {
    Add(name, [this, shape, schedule](const Aabo3& aabo) {
      WithShape(shape, floats_.view(), aabo,
                [&](const auto& view, const auto& query) {
                  RejectMask(view, query, mask_, How(schedule));
                });
    });
  }

  void AddGated() {
    Add("AABB gated by " + std::to_string(kGate) + ", mask",
        [this, scan = GatedScanFor(target_),
         planes =
             PlanesOf(ShapeKind::kAabb, floats_.view())](const Aabo3& aabo) {
          const auto query = detail::Planes(aabo.aabb());
          scan(ShapeKind::kAabb, kGate, planes.data(), query.data(), size(),
               mask_.data());
        });
  }

  template <typename World>
  void AddOutputs(const std::string& name, const World& world) {
    Add(name + ", indices", [this, &world](const Aabo3& query) {
      std::ignore = Survivors(world, query, indices_, How(Schedule::kAuto));
    });
    Add(name + ", count", [this, &world](const Aabo3& query) {
      std::ignore = CountSurvivors(world, query, How(Schedule::kAuto));
    });
    Add(name + ", any", [this, &world](const Aabo3& query) {
      std::ignore = AnySurvivor(world, query, How(Schedule::kAuto));
    });
  }

  Target target_;
  const std::vector<Aabo3>& queries_;
  AaboWorld3 floats_;
  QuantizedWorld<AaboView3> quantized_world_;
  std::vector<std::uint64_t> mask_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::string> names_;
  std::vector<Case> cases_;  // of each name with all queries, and with few
};

}  // namespace

void AddQueryParts(const Workload& workload, ThroughputParts& parts) {
  // There is nothing to compare with few.
  if (workload.timed_queries.size() <= kFewQueries) return;
  parts.push_back([&workload](Throughput& throughput) {
    for (std::size_t objects : kSizes) {
      SmallWorld(workload, objects, throughput.targets().front())
          .Run(throughput);
    }
  });
}

}  // namespace halfspace::bench
