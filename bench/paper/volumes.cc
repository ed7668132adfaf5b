#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "bench/base/text.h"
#include "bench/paper/dimensions.h"
#include "bench/sections/run.h"
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

void AddRows(Run& run, VolumeSet& set, const std::string& name,
             const Counts& counts, Table& table) {
  const auto count = [&counts](Volume volume) {
    return static_cast<double>(counts[static_cast<std::size_t>(volume)]);
  };
  for (Target target : run.TargetsIn(name)) {
    std::vector<Case> cases;
    cases.reserve(kVolumeTests.size());
    for (const VolumeTest& test : kVolumeTests) {
      cases.push_back(set.MakeCase("volumes/" + name + "/" + NameOf(target) +
                                       "/" + NameOf(test.volume) + "/" +
                                       test.schedule,
                                   test, target));
    }
    const std::vector<Timing> ns = run.Time(cases);
    for (std::size_t t = 0; t < kVolumeTests.size(); ++t) {
      const VolumeTest& test = kVolumeTests[t];
      table.Add({NameOf(test.volume), test.schedule, name, NameOf(target),
                 PlanesOf(test.volume) * sizeof(float), ns[t].Median(),
                 RatioOf(ns[t], ns[0]),
                 count(test.volume) / std::max(count(Volume::kAabb), 1.0)});
    }
  }
}

}  // namespace

Tables RunVolumes(Run& run) {
  const std::uint64_t seed = run.options.seed;
  const VolumeObjects objects(
      run.input() != nullptr
          ? FileSource(*run.input(), Fewer(kMostOfFile, run.options.objects),
                       seed)
          : SceneSource(Fewer(kSceneObjects, run.options.objects), seed),
      kTimedQueries);
  const Counts counts = CountSurvivorsOf(objects);
  Table table{"volumes",
              "bounding volumes of " + objects.name + " at the same layout",
              {Key("volume"), Key("schedule"), Key("set"), Key("target"),
               Value("bytes", "", 0), Value("time", "ns", 4),
               Lower("over simplex"), Value("survivors / AABB")}};
  for (const WorkingSetSize& size : run.Reached({"L2", "memory"})) {
    VolumeSet set(objects, size.objects);
    AddRows(run, set, size.name, counts, table);
  }
  table.notes = run.NotReached();
  Table dimensions = DimensionsTable();
  for (const WorkingSetSize& size : run.Reached({"L2"})) {
    for (std::size_t d = 2; d <= 4; ++d) {
      AddDimension(run, d, size.bytes, dimensions);
    }
  }
  return {table, dimensions};
}

}  // namespace halfspace::bench
