#include <algorithm>
#include <memory>
#include <utility>

#include "bench/base/text.h"
#include "bench/baselines/target_loops.h"
#include "bench/sections/aims.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/sections/single_builds.h"
#include "bench/worlds/build_check.h"
#include "bench/worlds/build_source.h"

namespace halfspace::bench {
namespace {

// A build takes long enough for less time than the scans are given.
Effort ShareOf(Effort effort) {
  effort.seconds_per_repetition /= 5.0;
  return effort;
}

bool IsInCache(const WorkingSetSize& size) { return size.name != "memory"; }

struct Rounding {
  const char* name;
  bool tightest;
};

// The tightest D of a sphere is computed for so long that its size tells
// nothing more.
std::vector<Rounding> RoundingsOf(BuildKind kind, bool is_in_cache) {
  std::vector<Rounding> roundings = {{"within-ulp", false}};
  if (kind == BuildKind::kBoxes ||
      (kind == BuildKind::kSpheres && is_in_cache)) {
    roundings.push_back({"tightest", true});
  }
  return roundings;
}

// The builds of one kind at one size, and the copies they are measured by: they
// share their memory, and are timed together.
class BuildGroup {
 public:
  BuildGroup(BuildKind kind, const WorkingSetSize& size,
             const Workload& workload, const std::vector<Target>& targets)
      : working_set_(size.name),
        source_(MakeBuildSource(kind, workload, size.bytes)),
        rounds_(std::max<std::size_t>(1, kObjectsPerRun / source_.items)) {
    for (CopyWay way : kCopyWays) {
      // Stores past the caches only lose in them.
      if (IsStreamed(way) && IsInCache(size)) continue;
      AddCopy(way);
    }
    for (Target target : targets) {
      for (const Rounding& rounding : RoundingsOf(kind, IsInCache(size))) {
        AddBuild(target, rounding);
      }
    }
  }

  void Run(bench::Run& run, Table& table) {
    const std::vector<Timing> timings = run.Time(cases_, ShareOf(run.effort));
    const double bytes_per_item = static_cast<double>(source_.copy.bytes()) /
                                  static_cast<double>(source_.items);
    // The fastest copy is the ceiling.
    std::size_t copy = 0;
    for (std::size_t i = 0; i < copies_.size(); ++i) {
      if (timings[i].Median() < timings[copy].Median()) copy = i;
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Timing& timing = timings[copies_.size() + i];
      Cell percent = RatioOf(timings[copy], timing).Percent();
      Row& row = rows_[i].cells;
      // Boxes out of the caches have an aim.
      if (rows_[i].has_aim) {
        const double aim = aims::kBuild.For(rows_[i].target);
        percent =
            percent.With(*percent.value >= aim ? Flag::kMet : Flag::kMissed);
      }
      row.insert(row.end(), {timing.Median(), bytes_per_item / timing.Median(),
                             percent, NameOf(copies_[copy])});
      table.Add(row);
    }
  }

 private:
  struct Planned {
    Row cells;
    Target target;
    bool has_aim;
  };

  Case MakeCase(std::string name) const {
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(source_.items * rounds_);
    return c;
  }

  // With the widest vectors, whatever is measured.
  void AddCopy(CopyWay way) {
    Case c = MakeCase("copy/" + working_set_ + "/" + source_.shapes + "-to-" +
                      source_.planes + "/" + NameOf(way));
    c.run = [this, way, copy = LoopsFor(SupportedTargets().front()).copy] {
      for (std::size_t i = 0; i < rounds_; ++i) {
        copy(way, source_.copy);
      }
    };
    copies_.push_back(way);
    cases_.push_back(std::move(c));
  }

  void AddBuild(Target target, const Rounding& rounding) {
    rows_.push_back({{source_.shapes, source_.planes, rounding.name,
                      NameOf(target), working_set_, source_.objects,
                      source_.items == source_.objects ? "object" : "point"},
                     target,
                     source_.shapes == std::string("boxes") &&
                         source_.planes == std::string("aabo") &&
                         !rounding.tightest && working_set_ == "memory"});
    Case c = MakeCase("build/" + working_set_ + "/" + NameOf(target) + "/" +
                      source_.shapes + "-to-" + source_.planes + "/" +
                      rounding.name);
    const FitOptions options{.tightest = rounding.tightest, .target = target};
    c.check = [this, options] { return CheckBuild(source_, options); };
    c.run = [this, options] {
      for (std::size_t i = 0; i < rounds_; ++i) source_.build(options, nullptr);
    };
    cases_.push_back(std::move(c));
  }

  std::string working_set_;
  BuildSource source_;
  std::size_t rounds_;
  std::vector<CopyWay> copies_;
  std::vector<Planned> rows_;
  std::vector<Case> cases_;  // the copies, then the rows
};

}  // namespace

Tables RunBuild(Run& run) {
  Table builds{
      "build",
      "bulk builders against copying the same bytes",
      {Key("shapes"), Key("planes"), Key("rounding"), Key("target"), Key("set"),
       Key("objects"), Key("item"), Value("ns/item"), Value("GB/s", "", 1),
       Higher("% of copy", "", 0), Value("copy")}};
  const Workload& workload = run.Measured();
  const std::vector<WorkingSetSize> sizes = run.Reached({"L2", "memory"});
  std::size_t part = 0;
  for (const WorkingSetSize& size : sizes) {
    for (BuildKind kind : kBuildKinds) {
      run.progress.BeginPart(part++, sizes.size() * kBuildKinds.size() + 1);
      if (run.is_quick() && !IsInCache(size) && kind != BuildKind::kBoxes) {
        continue;
      }
      BuildGroup(kind, size, workload, run.targets).Run(run, builds);
    }
  }
  builds.notes = run.NotReached();
  Table singles{"build: single",
                "one shape at a time, in 3 dimensions",
                {Key("call"), Lower("time", "ns")}};
  for (const Timing& timing :
       run.Time(SingleBuildCases(), ShareOf(run.effort))) {
    singles.Add(
        {timing.name.substr(timing.name.find('/') + 1), SpreadOf(timing)});
  }
  return {builds, singles};
}

}  // namespace halfspace::bench
