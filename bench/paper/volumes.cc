// The paper's bounding volumes side by side: at the same layout, in other
// dimensions, around boxes; and what the second simplex of an AABO costs.
#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/paper/volume_set.h"
#include "bench/paper/work_count.h"
#include "bench/sections/contest.h"
#include "bench/sections/verdict.h"
#include "bench/worlds/moved_clouds.h"
#include "bench/worlds/working_set.h"
#include "bench/worlds/workload.h"
#include "halfspace/reject.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

// Survivors are counted on so many pairs.
constexpr std::size_t kCountedPairs = std::size_t{1} << 27;

// So few that they are bounded in a fraction of a second.
std::size_t ObjectsOf(const Run& run) {
  return std::min(kDifferentVolumes, run.options.objects != 0
                                         ? run.options.objects
                                         : kDifferentVolumes);
}

Table VolumesTable(Run& run) {
  Table table{"volumes",
              "bounding volumes of the scene at the same layout",
              {Key("volume"), Key("schedule"), Key("set"), Key("target"),
               Value("bytes", "", 0), Value("time", "ns", 4),
               Lower("over simplex"), Value("survivors / AABB")}};
  std::map<Volume, double> survivors;
  for (const WorkingSetSize& size : run.Reached({"L2", "memory"})) {
    VolumeSet set(ScenePoints(run.options.seed), size.objects, kTimedQueries);
    for (std::size_t v = 0; v < kVolumes && size.name == "L2"; ++v) {
      const auto volume = static_cast<Volume>(v);
      survivors[volume] = static_cast<double>(
          set.Survivors(volume, kCountedPairs / size.objects));
    }
    for (Target target : run.TargetsIn(size.name)) {
      Contest ns(run, "volumes");
      std::vector<Volume> volumes;
      for (std::size_t v = 0; v < kVolumes; ++v) {
        const auto volume = static_cast<Volume>(v);
        for (const auto& [name, schedule] : SchedulesOf(volume)) {
          ns.Add(
              {NameOf(volume), name, size.name, NameOf(target)},
              set.MakeCase(volume, {.schedule = schedule, .target = target}));
          volumes.push_back(volume);
        }
      }
      ns.Time();
      ns.AddTo(table, [&](std::size_t i) -> Row {
        return {
            PlanesOf(volumes[i]) * sizeof(float), ns.Median(i),
            RatioOf(ns.timing(i), ns.timing(0)),
            survivors[volumes[i]] / std::max(survivors[Volume::kAabb], 1.0)};
      });
    }
  }
  table.notes = run.NotReached();
  table.notes.emplace_back(
      "Simplex and box have their ratio in the table \"verdict\" of "
      "cpuinfo-bench, of many worlds. Here it is of one world, whose place in "
      "memory changes it by some per cent.");
  return table;
}

// The scene of so many dimensions, with planes of that many bytes.
template <int kDims>
void AddDimension(Run& run, std::size_t bytes, Table& table) {
  const SceneOf<kDims> scene = MakeSceneOf<kDims>(
      std::max(kSetStep, bytes / sizeof(Aabo<kDims>) / kSetStep * kSetStep),
      kTimedQueries, run.options.seed, kCloudRadius<kDims>);
  const AaboView<kDims> view = scene.objects.view();
  const Target target = run.best();
  std::vector<std::uint64_t> mask(MaskWords(view.size));
  std::vector<std::uint64_t> expected(mask.size());
  // Calls f(view, query) with the objects and query q as bounds of a shape.
  const auto with = [&](ShapeKind shape, std::size_t q, auto f) {
    WithShape(shape, view, scene.queries[q], f);
  };
  Contest ns(run, "volumes");
  for (ShapeKind shape :
       {ShapeKind::kSimplex, ShapeKind::kAabb, ShapeKind::kAabo}) {
    const std::size_t schedules = shape == ShapeKind::kSimplex ? 1 : 2;
    for (const auto& [name, how] : SchedulesOf(shape).first(schedules)) {
      const Options options{.schedule = how, .target = target};
      const auto scan = [&, shape, options](std::size_t q) {
        with(shape, q, [&](const auto& objects, const auto& query) {
          RejectMask(objects, query, mask, options);
        });
      };
      Case c = CaseOfQueries(scene.queries.size(), view.size, scan);
      c.items *= static_cast<double>(view.size);
      c.check = CheckOf(
          2, "not the scalar reference's", [&, shape, scan](std::size_t q) {
            with(shape, q, [&](const auto& objects, const auto& query) {
              reference::RejectMask(objects, query, expected.data());
            });
            scan(q);
            return mask == expected;
          });
      ns.Add({std::size_t{kDims}, NameOf(shape), name}, std::move(c));
    }
  }
  ns.Time();
  PerShape<double> survivors;
  for (std::size_t q = 0;
       q < std::min(scene.queries.size(), kCountedPairs / view.size); ++q) {
    AddSurvivors(view, scene.queries[q], survivors);
  }
  table.Add({std::size_t{kDims}, NameOf(target), ns.Median(0), ns.Median(1),
             std::min(ns.Median(1), ns.Median(2)),
             std::min(ns.Median(3), ns.Median(4)),
             survivors.simplex / survivors.aabb});
}

Table DimensionsTable(Run& run) {
  Table table{"volumes: dimensions",
              "the scene in 2, 3 and 4 dimensions, L2: ns per object",
              {Key("dimensions"), Key("target"), Value("simplex", "ns", 4),
               Value("AABB flat", "ns", 4), Value("AABB", "ns", 4),
               Value("AABO", "ns", 4), Value("c of simplex")}};
  for (const WorkingSetSize& size : run.Reached({"L2"})) {
    AddDimension<2>(run, size.bytes, table);
    AddDimension<3>(run, size.bytes, table);
    AddDimension<4>(run, size.bytes, table);
  }
  table.notes = {"AABB, AABO: flat or staged, whichever is faster."};
  return table;
}

// Is a world of boxes faster as AABOs? Their D rejects nothing more. But minima
// and D enclose a volume, so a first stage of these four half-spaces rejects
// most objects. The minima of a box alone enclose none.
Table BoxesTable(Run& run) {
  Table table{"volumes: boxes",
              "a world of boxes as AABBs, and as AABOs of the boxes: ns per "
              "object",
              {Key("set"), Key("target"), Key("size"),
               Value("AABB flat", "ns", 3), Value("AABB staged", "ns", 3),
               Value("AABB by axis", "ns", 3), Value("AABB auto", "ns", 3),
               Value("AABO auto", "ns", 3), Higher("best AABB / AABO")}};
  const std::vector<double> percents =
      run.options.is_quick ? std::vector<double>{2.0}
                           : std::vector<double>{0.3, 1.0, 2.0, 3.0, 10.0};
  for (double percent : percents) {
    const Workload boxes =
        BoxesOf(SceneOfSize(percent / 100.0, ObjectsOf(run), run.options.seed));
    for (const WorkingSetSize& size :
         run.Reached({"L1", "L2", "L3", "memory"})) {
      if (run.options.is_quick && size.name != "L2") continue;
      WorkingSet set(boxes, size);
      for (Target target : run.TargetsIn(size.name)) {
        Contest contest(run, "volumes/boxes");
        Row row = {size.name, NameOf(target),
                   Fixed(percent, percent < 1.0 ? 1 : 0) + " %"};
        for (const auto& [name, schedule] : kSchedules) {
          contest.Add({row[0], row[1], row[2], "AABB", name},
                      set.LibraryCase(ShapeKind::kAabb,
                                      {.schedule = schedule, .target = target}),
                      Who::kCompetitor);
        }
        contest.Add({row[0], row[1], row[2], "AABO"},
                    set.LibraryCase(ShapeKind::kAabo, {.target = target}));
        contest.Time();
        for (std::size_t i = 0; i < contest.size(); ++i) {
          row.push_back(contest.Median(i));
        }
        row.push_back(Marked(
            RatioOf(contest.fastest(), contest.timing(std::size(kSchedules)))));
        table.Add(std::move(row));
      }
    }
  }
  table.notes = {
      "size: an object's side over the world's. best: the AABB's fastest "
      "schedule. *: the AABO is faster. =: neither. [ ]: range of the "
      "repetitions."};
  return table;
}

}  // namespace

Tables RunVolumes(Run& run) {
  return {VolumesTable(run), DimensionsTable(run), BoxesTable(run)};
}

// How often the AABO's second simplex is read, and what that saves.
Tables RunDual(Run& run) {
  constexpr std::size_t kFewestCounted = 8;
  Table table{
      "dual",
      "how often the AABO's second simplex is read, and what that saves",
      {Key("content"), Key("set"), Key("target"), Value("of 64", "%", 3),
       Value("flat", "ns", 3), Value("staged", "ns", 3),
       Lower("staged / flat")}};
  const Workload& content = run.Measured();
  for (WorkingSet* set : run.Sets({"L2", "memory"})) {
    const std::size_t counted =
        std::min(content.timed_queries.size(),
                 std::max(kFewestCounted, kCountedPairs / set->objects()));
    std::size_t batches = 0;
    for (std::size_t q = 0; q < counted; ++q) {
      SurvivorMask(set->view().simplex(), content.timed_queries[q].down(),
                   set->mask());
      batches += BatchesLeft(set->mask(), 64);
    }
    for (Target target : run.TargetsIn(set->name())) {
      Contest ns(run, "dual");
      for (Schedule schedule : {Schedule::kFlat, Schedule::kStaged}) {
        ns.Add({set->name(), NameOf(target)},
               set->LibraryCase(ShapeKind::kAabo,
                                {.schedule = schedule, .target = target}));
      }
      ns.Time();
      table.Add({content.name, set->name(), NameOf(target),
                 100.0 * static_cast<double>(batches) /
                     static_cast<double>(set->mask().size() * counted),
                 ns.Median(0), ns.Median(1),
                 RatioOf(ns.timing(1), ns.timing(0))});
    }
  }
  table.notes = run.NotReached();
  table.notes.emplace_back(
      "of 64: the share of batches of 64 objects that need the second "
      "simplex.");
  return {table};
}

}  // namespace halfspace::bench
