#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"
#include "bench/worlds/scene_of_dimension.h"
#include "bench/worlds/volume_set.h"
#include "bench/worlds/working_set.h"
#include "halfspace/reject.h"
#include "tests/reference/reference.h"

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

constexpr std::size_t kObjectsStep = 4096;
constexpr std::size_t kCheckedQueries = 2;

// The library's calls in the scene of so many dimensions.
template <int kDims>
class DimensionCases {
 public:
  DimensionCases(std::size_t bytes, std::uint64_t seed)
      : scene_(MakeSceneOf<kDims>(
            std::max(kObjectsStep,
                     bytes / sizeof(Aabo<kDims>) / kObjectsStep * kObjectsStep),
            kTimedQueries, seed)),
        view_(scene_.objects.view()),
        mask_(MaskWords(view_.size)) {}

  void AddRow(Run& run, Table& table) {
    const Target target = run.best();
    const auto simplex = [this](const Aabo<kDims>& query, auto&& f) {
      f(view_.simplex(), query.down());
    };
    const auto box = [this](const Aabo<kDims>& query, auto&& f) {
      f(view_.aabb(), query.aabb());
    };
    const auto all = [this](const Aabo<kDims>& query, auto&& f) {
      f(view_, query);
    };
    const Options flat = {.schedule = Schedule::kFlat, .target = target};
    const Options staged = {.schedule = Schedule::kStaged, .target = target};
    const std::vector<Timing> ns = run.Time(
        {MakeCase("simplex/flat", flat, simplex),
         MakeCase("aabb/flat", flat, box), MakeCase("aabb/staged", staged, box),
         MakeCase("aabo/flat", flat, all),
         MakeCase("aabo/staged", staged, all)});
    const std::size_t fastest_box = ns[1].Median() <= ns[2].Median() ? 1 : 2;
    const std::size_t fastest_aabo = ns[3].Median() <= ns[4].Median() ? 3 : 4;
    PerShape<double> sums;
    const std::size_t queries =
        std::min(scene_.queries.size(), kCountedPairs / view_.size);
    for (std::size_t q = 0; q < queries; ++q) {
      const Aabo<kDims>& query = scene_.queries[q];
      const auto add = [](double& sum, std::size_t count) {
        sum += static_cast<double>(count);
      };
      add(sums.aabb, CountSurvivors(view_.aabb(), query.aabb()));
      add(sums.simplex, CountSurvivors(view_.simplex(), query.down()));
      add(sums.aabo, CountSurvivors(view_, query));
    }
    table.Add({std::size_t{kDims}, NameOf(target), ns[0].Median(),
               RatioOf(ns[1], ns[0]), RatioOf(ns[fastest_box], ns[0]),
               RatioOf(ns[fastest_aabo], ns[0]), sums.simplex / sums.aabb,
               sums.aabo / sums.aabb});
  }

 private:
  // with_shape(query, f) calls f(view, query) of a shape.
  template <typename WithShape>
  Case MakeCase(const std::string& name, const Options& options,
                const WithShape& with_shape) {
    const std::string group = "volumes/" + std::to_string(kDims) + "D/";
    const std::size_t per_run =
        std::max<std::size_t>(1, kObjectsPerRun / view_.size);
    const auto scan = [this, options, with_shape](const Aabo<kDims>& query) {
      with_shape(query, [&](const auto& view, const auto& shape) {
        RejectMask(view, shape, mask_, options);
      });
    };
    Case c;
    c.name = group + name;
    c.group = group;
    c.items = static_cast<double>(view_.size * per_run);
    c.check = [this, scan, with_shape]() -> std::string {
      std::vector<std::uint64_t> expected(mask_.size());
      for (std::size_t q = 0; q < kCheckedQueries; ++q) {
        with_shape(scene_.queries[q], [&](const auto& view, const auto& shape) {
          reference::RejectMask(view, shape, expected.data());
        });
        scan(scene_.queries[q]);
        if (mask_ != expected) return "the mask is not the scalar reference's";
      }
      return {};
    };
    c.run = [this, scan, per_run, next = std::size_t{0}]() mutable {
      for (std::size_t i = 0; i < per_run; ++i) {
        scan(scene_.queries[next]);
        next = next + 1 == scene_.queries.size() ? 0 : next + 1;
      }
    };
    return c;
  }

  SceneOf<kDims> scene_;
  AaboView<kDims> view_;
  std::vector<std::uint64_t> mask_;
};

// A world of boxes, tested as boxes and as octahedra around them: their minima
// and D, then the rest for groups with survivors. D rejects nothing more, but
// the minima with D enclose a volume, and those of a box do not.
Table BoxesTable(Run& run) {
  Table table{
      "volumes: boxes",
      "a world of boxes as AABBs, and as AABOs of the boxes: ns per "
      "object",
      {Key("set"), Key("target"), Key("size"), Value("AABB flat", "ns", 3),
       Value("AABB staged", "ns", 3), Value("AABB by axis", "ns", 3),
       Value("AABB auto", "ns", 3), Lower("auto / best"),
       Value("AABO auto", "ns", 3), Higher("best AABB / AABO")}};
  const std::vector<double> percents =
      run.is_quick() ? std::vector<double>{2.0}
                     : std::vector<double>{0.3, 1.0, 2.0, 3.0, 10.0};
  for (double percent : percents) {
    const Workload boxes = BoxesOf(
        SceneOfSize(percent / 100.0, Fewer(kSceneObjects, run.options.objects),
                    run.options.seed),
        kSceneObjects);
    for (const WorkingSetSize& size :
         run.Reached({"L1", "L2", "L3", "memory"})) {
      if (run.is_quick() && size.name != "L2") continue;
      WorkingSet set(boxes, size);
      for (Target target : run.TargetsIn(size.name)) {
        const std::string name = "volumes/boxes/" + size.name + "/" +
                                 NameOf(target) + "/" + Fixed(percent, 1) + "/";
        const auto make = [&](const char* what, ShapeKind shape,
                              Schedule schedule) {
          return set.LibraryCase(name + what, shape,
                                 {.schedule = schedule, .target = target});
        };
        const std::vector<Timing> ns = run.Time(
            {make("AABB/flat", ShapeKind::kAabb, Schedule::kFlat),
             make("AABB/staged", ShapeKind::kAabb, Schedule::kStaged),
             make("AABB/by-axis", ShapeKind::kAabb, Schedule::kStagedByAxis),
             make("AABB/auto", ShapeKind::kAabb, Schedule::kAuto),
             make("AABO/auto", ShapeKind::kAabo, Schedule::kAuto)});
        const Timing& best = *std::min_element(
            ns.begin(), ns.end() - 1, [](const Timing& a, const Timing& b) {
              return a.Median() < b.Median();
            });
        const Ratio ratio = RatioOf(best, ns.back());
        table.Add({size.name, NameOf(target),
                   Fixed(percent, percent < 1.0 ? 1 : 0) + " %", ns[0].Median(),
                   ns[1].Median(), ns[2].Median(), ns[3].Median(),
                   Cell(RatioOf(ns[3], best)), ns[4].Median(),
                   Cell(ratio).With(ratio.low > 1.0     ? Flag::kWinner
                                    : ratio.high >= 1.0 ? Flag::kTie
                                                        : Flag::kNone)});
      }
    }
  }
  table.notes = {
      "size: an object's side over the world's. best: the AABB's fastest "
      "schedule. *: the AABO is faster. =: neither. [ ]: range of the "
      "repetitions."};
  return table;
}

Table DimensionsTable() {
  return {"volumes: dimensions",
          "the scene in 2, 3 and 4 dimensions, L2: times over the simplex's",
          {Key("dimensions"), Key("target"), Value("simplex", "ns", 4),
           Higher("flat AABB"), Higher("best AABB"), Lower("best AABO"),
           Value("c of simplex"), Value("c of AABO")}};
}

void AddDimension(Run& run, std::size_t dimensions, std::size_t bytes,
                  Table& table) {
  const std::uint64_t seed = run.options.seed;
  switch (dimensions) {
    case 2:
      return DimensionCases<2>(bytes, seed).AddRow(run, table);
    case 3:
      return DimensionCases<3>(bytes, seed).AddRow(run, table);
    default:
      return DimensionCases<4>(bytes, seed).AddRow(run, table);
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
  const std::string one_world =
      "Simplex and box in 3 dimensions have their ratio in the table "
      "\"verdict\", of many worlds. Here it is of one world, whose place in "
      "memory changes it by some per cent.";
  table.notes = run.NotReached();
  table.notes.push_back(one_world);
  Table dimensions = DimensionsTable();
  dimensions.notes = {one_world};
  for (const WorkingSetSize& size : run.Reached({"L2"})) {
    for (std::size_t d = 2; d <= 4; ++d) {
      AddDimension(run, d, size.bytes, dimensions);
    }
  }
  return {table, dimensions, BoxesTable(run)};
}

}  // namespace halfspace::bench
