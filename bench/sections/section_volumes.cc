#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "bench/sections/alternatives.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "bench/worlds/volume_set.h"

namespace halfspace::bench {
namespace {

// The scene's objects take a fraction of a second to bound, and so do those of
// most files.
constexpr std::size_t kSceneObjects = std::size_t{1} << 17;
constexpr std::size_t kMostOfFile = kMostObjectsWithCorners;

// Survivors are counted on so many pairs, of all different objects.
constexpr std::size_t kCountedPairs = std::size_t{1} << 27;

std::size_t Fewer(std::size_t objects, std::size_t most) {
  return most == 0 ? objects : std::min(objects, most);
}

using Counts = std::array<std::size_t, kVolumes>;

Counts CountSurvivorsOf(const VolumeObjects& objects) {
  VolumeSet set(objects, (objects.objects.size() + 63) / 64 * 64);
  const std::size_t queries =
      std::max<std::size_t>(1, kCountedPairs / set.size());
  Counts counts{};
  for (std::size_t v = 0; v < kVolumes; ++v) {
    counts[v] = set.Survivors(static_cast<Volume>(v), queries);
  }
  return counts;
}

void PlanTests(Plan<VolumeRow>& plan, VolumeSet& set, const std::string& name,
               const Counts& counts, Target target) {
  const std::string prefix =
      "volumes/" + name + "/" + std::string(target.name()) + "/";
  std::size_t simplex = 0;
  for (std::size_t t = 0; t < kVolumeTests.size(); ++t) {
    const VolumeTest& test = kVolumeTests[t];
    Case c = set.MakeCase(prefix + NameOf(test.volume) + "/" + test.schedule,
                          test, target);
    c.group = prefix;
    const std::size_t place = plan.AddCase(std::move(c));
    if (t == 0) simplex = place;
    VolumeRow row;
    row.volume = NameOf(test.volume);
    row.schedule = test.schedule;
    row.target = target.name();
    row.working_set = name;
    row.objects = set.size();
    row.bytes_per_object = PlanesOf(test.volume) * sizeof(float);
    const auto boxes =
        static_cast<double>(counts[static_cast<std::size_t>(Volume::kAabb)]);
    row.looseness =
        static_cast<double>(counts[static_cast<std::size_t>(test.volume)]) /
        std::max(boxes, 1.0);
    plan.AddRow(std::move(row), [place, simplex](const Timings& timings,
                                                 VolumeRow& timed) {
      timed.ns_per_object = timings[place].Median();
      timed.over_simplex = RatioOf(timings[place], timings[simplex]);
    });
  }
}

}  // namespace

VolumesResult RunVolumes(const Workload* input, std::size_t most_objects,
                         const std::vector<WorkingSetSize>& sizes,
                         std::uint64_t seed, bool is_quick,
                         const Context& context) {
  const VolumeObjects objects(
      input != nullptr
          ? FileSource(*input, Fewer(kMostOfFile, most_objects), seed)
          : SceneSource(Fewer(kSceneObjects, most_objects), seed),
      kTimedQueries);
  VolumesResult result;
  result.workload = objects.name;
  result.distinct = objects.objects.size();
  const Counts counts = CountSurvivorsOf(objects);
  Plan<VolumeRow> plan;
  std::vector<std::unique_ptr<VolumeSet>> sets;
  for (const WorkingSetSize& size : sizes) {
    sets.push_back(std::make_unique<VolumeSet>(objects, size.objects));
    for (Target target : context.targets) {
      if (IsMeasuredIn(size.name, target, is_quick, context)) {
        PlanTests(plan, *sets.back(), size.name, counts, target);
      }
    }
  }
  constexpr std::size_t kParts = 4;
  context.progress.BeginPart(0, kParts);
  plan.Run(context.effort, context, result.rows);
  sets.clear();
  const auto cache =
      std::find_if(sizes.begin(), sizes.end(),
                   [](const auto& size) { return size.name == "L2"; });
  if (cache == sizes.end()) return result;
  for (std::size_t d = 2; d <= 4; ++d) {
    context.progress.BeginPart(d - 1, kParts);
    result.dimensions.push_back(RunDimension(d, cache->bytes, seed, context));
  }
  return result;
}

}  // namespace halfspace::bench
