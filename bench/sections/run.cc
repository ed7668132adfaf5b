#include "bench/sections/run.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "bench/base/text.h"
#include "bench/baselines/triangles.h"
#include "bench/measure/groups.h"
#include "bench/worlds/workload.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kQuickObjects = std::size_t{1} << 19;

std::vector<Target> TargetsOf(const BenchOptions& options) {
  if (!options.target.empty()) return {TargetByName(options.target)};
  // One of each name: the best of the AVX-512 targets, which comes first.
  const auto all = SupportedTargets();
  std::vector<Target> targets;
  std::unique_copy(all.begin(), all.end(), std::back_inserter(targets),
                   [](Target a, Target b) { return NameOf(a) == NameOf(b); });
  return targets;
}

Effort EffortOf(const BenchOptions& options) {
  Effort effort = options.is_quick          ? Effort{3, 0.003}
                  : options.details.empty() ? Effort{5, 0.006}
                                            : Effort{7, 0.015};
  if (options.repetitions != 0) effort.repetitions = options.repetitions;
  return effort;
}

}  // namespace

Run::Run(const BenchOptions& run_options, std::optional<Workload> input,
         Progress& run_progress)
    : options(run_options),
      progress(run_progress),
      machine(DescribeMachine()),
      targets(TargetsOf(run_options)),
      effort(EffortOf(run_options)),
      input_(std::move(input)) {
  // Before anything is allocated: a system that overcommits kills the program
  // without a word. An eighth is left to the sections.
  const std::size_t available = machine.available_memory;
  const std::size_t needed = SceneObjects() * sizeof(Aabo3);
  if (NeedsScene() && available != 0 && needed > available / 8 * 7) {
    throw UsageError("the scene of " + std::to_string(SceneObjects()) +
                     " objects takes " + Mebibytes(needed) +
                     ", too much for the " + Mebibytes(available) +
                     " that are free; choose fewer --objects");
  }
}

bool Run::NeedsScene() const {
  return ThisProgram().HasAny([this](const Section& section) {
    const unsigned needs_scene = kPaperScene | (input_ ? 0 : kScene);
    return (section.flags & needs_scene) != 0 && options.Wants(section.name);
  });
}

Target Run::best() const {
  const bool is_measured = std::find(targets.begin(), targets.end(),
                                     ChosenTarget()) != targets.end();
  return is_measured ? ChosenTarget() : targets.front();
}

std::size_t Run::SceneObjects() const {
  if (options.objects != 0) return options.objects;
  return options.is_quick ? kQuickObjects : kPaperObjects;
}

std::size_t Run::MostObjects(std::size_t usual, std::size_t of_quick) const {
  const std::size_t most = options.is_quick ? of_quick : usual;
  return options.objects == 0 ? most : std::min(most, options.objects);
}

const Workload& Run::Scene() {
  if (!scene_.objects.empty()) return scene_;
  scene_ = MakeScene(SceneObjects(),
                     options.queries != 0 ? options.queries : kTimedQueries,
                     options.seed);
  scene_.timed_queries = scene_.queries;
  if (options.queries == 0) scene_.queries.resize(kPaperQueries);
  // What the working sets may still take.
  machine.available_memory = FreeMemory();
  return scene_;
}

std::vector<WorkingSetSize> Run::Reached(
    const std::vector<std::string>& names) const {
  std::vector<WorkingSetSize> sizes;
  for (const WorkingSetSize& size : WorkingSetSizes(machine)) {
    if (size.why_not_reached.empty() &&
        std::find(names.begin(), names.end(), size.name) != names.end()) {
      sizes.push_back(size);
    }
  }
  return sizes;
}

std::vector<WorkingSet*> Run::Sets(const std::vector<std::string>& names) {
  Measured();
  std::vector<WorkingSet*> sets;
  for (const auto& size : Reached(names)) sets.push_back(&Set(size));
  return sets;
}

WorkingSet& Run::Set(const WorkingSetSize& size) {
  return sets_.try_emplace(size.name, Measured(), size).first->second;
}

WorkingSet& Run::SmallSet() { return Set(WorkingSetSizes(machine)[1]); }

std::vector<std::string> Run::NotReached() const {
  std::vector<std::string> reasons;
  for (const WorkingSetSize& size : WorkingSetSizes(machine)) {
    if (!size.why_not_reached.empty()) {
      reasons.push_back("Not measured in " + size.name + ": " +
                        size.why_not_reached + ".");
    }
  }
  return reasons;
}

ExactTest Run::TheExactTest() {
  if (options.exact_ns) return {"given", *options.exact_ns};
  if (!exact_test_) {
    const auto pairs = TrianglePairs(kTimedQueries, options.seed);
    std::size_t touching = 0;
    Case c = InTurn(pairs.size(), pairs.size(), [&](std::size_t i) {
      touching += Touch(pairs[i][0], pairs[i][1]) ? 1 : 0;
    });
    c.name = "exact/triangle-triangle";
    c.check = CheckOf(pairs.size(), "touches one way only", [&](std::size_t i) {
      return Touch(pairs[i][0], pairs[i][1]) == Touch(pairs[i][1], pairs[i][0]);
    });
    exact_test_ = {"triangle-triangle", Measure({c}, effort).front().Median()};
    KeepResult(static_cast<std::uint32_t>(touching));
  }
  return *exact_test_;
}

std::size_t Run::VerdictGroups() const {
  // An odd number has a median that is one of them.
  return std::min(kGroups, RepetitionsOr(kGroups) | 1);
}

void Run::AddVerdictGroup() {
  if (!verdict_) verdict_ = std::make_unique<Verdict>(*this);
  if (verdict_->groups() >= VerdictGroups()) return;
  progress.Begin(kVerdictGroup);
  verdict_->AddGroup(*this);
}

const Verdict& Run::TheVerdict() {
  while (!verdict_ || verdict_->groups() < VerdictGroups()) AddVerdictGroup();
  return *verdict_;
}

}  // namespace halfspace::bench
