#include <algorithm>
#include <memory>
#include <utility>

#include "bench/baselines/stream_copier.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "bench/sections/single_builds.h"
#include "bench/worlds/build_check.h"
#include "bench/worlds/build_source.h"

namespace halfspace::bench {
namespace {

// A build takes long enough for less time than the scans are given.
constexpr double kShareOfEffort = 1.0 / 5.0;

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
             const Workload& workload, const Context& context)
      : context_(context),
        working_set_(size.name),
        source_(MakeBuildSource(kind, workload, size.bytes)),
        rounds_(std::max<std::size_t>(1, kObjectsPerRun / source_.items)) {
    for (CopyWay way : kCopyWays) {
      // Stores past the caches only lose in them.
      if (IsStreamed(way) && IsInCache(size)) continue;
      if (CanCopy(way, source_.copy)) AddCopy(way);
    }
    for (Target target : context.targets) {
      for (const Rounding& rounding : RoundingsOf(kind, IsInCache(size))) {
        AddBuild(target, rounding);
      }
    }
  }

  void Run(std::vector<BuildRow>& rows) {
    Effort effort = context_.effort;
    effort.seconds_per_repetition *= kShareOfEffort;
    plan_.Run(effort, context_, rows);
  }

 private:
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
    c.run = [this, way] {
      for (std::size_t i = 0; i < rounds_; ++i) {
        CopyStreams(way, source_.copy, source_.objects,
                    SupportedTargets().front());
      }
    };
    copies_.emplace_back(way, plan_.AddCase(std::move(c)));
  }

  void AddBuild(Target target, const Rounding& rounding) {
    BuildRow row;
    row.shapes = source_.shapes;
    row.planes = source_.planes;
    row.rounding = rounding.name;
    row.target = target.name();
    row.working_set = working_set_;
    row.objects = source_.objects;
    row.item = source_.items == source_.objects ? "object" : "point";
    Case c = MakeCase("build/" + working_set_ + "/" + row.target + "/" +
                      row.shapes + "-to-" + row.planes + "/" + row.rounding);
    const FitOptions options{.tightest = rounding.tightest, .target = target};
    c.check = [this, options] { return CheckBuild(source_, options); };
    c.run = [this, options] {
      for (std::size_t i = 0; i < rounds_; ++i) source_.build(options, nullptr);
    };
    const std::size_t place = plan_.AddCase(std::move(c));
    plan_.AddRow(std::move(row),
                 [this, place](const Timings& timings, BuildRow& timed) {
                   Finish(timed, timings, timings[place]);
                 });
  }

  // The fastest copy is the ceiling.
  void Finish(BuildRow& row, const Timings& timings,
              const Timing& timing) const {
    const double bytes_per_item = static_cast<double>(source_.copy.bytes()) /
                                  static_cast<double>(source_.items);
    row.ns_per_item = timing.Median();
    row.gigabytes_per_second = bytes_per_item / row.ns_per_item;
    for (const auto& [way, place] : copies_) {
      const Ratio percent = RatioOf(timings[place], timing).Percent();
      if (!row.copy.empty() && percent.median >= row.percent_of_copy.median) {
        continue;
      }
      row.percent_of_copy = percent;
      row.copy = NameOf(way);
      row.copy_gigabytes_per_second = bytes_per_item / timings[place].Median();
    }
  }

  const Context& context_;
  std::string working_set_;
  BuildSource source_;
  std::size_t rounds_;
  std::vector<std::pair<CopyWay, std::size_t>> copies_;  // and their places
  Plan<BuildRow> plan_;
};

std::vector<SingleBuildRow> RunSingles(const Context& context) {
  Effort effort = context.effort;
  effort.seconds_per_repetition *= kShareOfEffort;
  std::vector<SingleBuildRow> rows;
  for (const Timing& timing : TimeCases(SingleBuildCases(), effort, context)) {
    rows.push_back(
        {timing.name.substr(timing.name.find('/') + 1), timing.Median()});
  }
  return rows;
}

std::vector<BuildThreshold> ThresholdsOf(const std::vector<BuildRow>& rows) {
  std::vector<BuildThreshold> thresholds;
  for (const BuildRow& row : rows) {
    if (row.shapes == "boxes" && row.planes == "aabo" &&
        row.rounding == "within-ulp" && row.working_set == "memory") {
      thresholds.push_back({row.target, row.percent_of_copy.median});
    }
  }
  return thresholds;
}

}  // namespace

BuildResult RunBuild(const Workload& workload,
                     const std::vector<WorkingSetSize>& sizes, bool is_quick,
                     const Context& context) {
  struct Part {
    BuildKind kind;
    const WorkingSetSize* size;
  };
  std::vector<Part> parts;
  for (const WorkingSetSize& size : sizes) {
    for (BuildKind kind : kBuildKinds) {
      if (is_quick && !IsInCache(size) && kind != BuildKind::kBoxes) continue;
      parts.push_back({kind, &size});
    }
  }
  BuildResult result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    context.progress.BeginPart(i, parts.size() + 1);
    BuildGroup(parts[i].kind, *parts[i].size, workload, context)
        .Run(result.rows);
  }
  result.thresholds = ThresholdsOf(result.rows);
  context.progress.BeginPart(parts.size(), parts.size() + 1);
  result.singles = RunSingles(context);
  return result;
}

}  // namespace halfspace::bench
