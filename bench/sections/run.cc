#include "bench/sections/run.h"

#include <algorithm>
#include <new>
#include <utility>

#include "bench/base/text.h"
#include "bench/baselines/triangles.h"
#include "bench/measure/groups.h"
#include "bench/worlds/random.h"
#include "bench/worlds/workload.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kQuickObjects = std::size_t{1} << 19;

std::vector<Target> TargetsOf(const BenchOptions& options) {
  if (!options.target.empty()) return {TargetByName(options.target)};
  // One of each name: the best of the AVX-512 targets, which comes first.
  std::vector<Target> targets;
  for (Target target : SupportedTargets()) {
    const bool is_new = std::none_of(
        targets.begin(), targets.end(),
        [target](Target other) { return NameOf(other) == NameOf(target); });
    if (is_new) targets.push_back(target);
  }
  return targets;
}

Effort EffortOf(const BenchOptions& options) {
  Effort effort;
  const bool is_page = options.details.empty();
  effort.repetitions = options.is_quick ? 3 : is_page ? 5 : 7;
  effort.seconds_per_repetition = options.is_quick ? 0.003
                                  : is_page        ? 0.006
                                                   : 0.015;
  if (options.repetitions != 0) effort.repetitions = options.repetitions;
  return effort;
}

// Of two triangles around each other, one test at a time.
ExactTest MeasureExactTest(Run& run) {
  // So many that no predictor learns them, around each other as candidates are.
  constexpr float kBetween = 0.75f;
  Random random(run.options.seed);
  const auto triangle = [&random] {
    Vector3 at;
    for (float& x : at) x = kBetween * random.Signed();
    Triangle corners;
    for (Vector3& corner : corners) {
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = at[k] + 0.5f * random.Signed();
      }
    }
    return corners;
  };
  std::vector<std::pair<Triangle, Triangle>> pairs;
  for (std::size_t i = 0; i < kTimedQueries; ++i) {
    pairs.emplace_back(triangle(), triangle());
  }
  std::size_t touching = 0;
  Case c = InTurn(pairs.size(), pairs.size(), [&](std::size_t i) {
    touching += Touch(pairs[i].first, pairs[i].second) ? 1 : 0;
  });
  c.name = "exact/triangle-triangle";
  c.check = [&pairs]() -> std::string {
    for (const auto& [a, b] : pairs) {
      if (Touch(a, b) != Touch(b, a)) return "a pair touches one way only";
    }
    return {};
  };
  const Ratio ns = SpreadOf(run.Time({c}).front());
  KeepResult(static_cast<std::uint32_t>(touching));
  return {"triangle-triangle", ns};
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
  if (NeedsScene() && available != 0 &&
      SceneObjects() * sizeof(Aabo3) > available / 8 * 7) {
    FailForMemory(", too much for the " + Mebibytes(available) +
                  " that are free");
  }
}

bool Run::NeedsScene() const {
  return std::any_of(
      ThisProgram().sections.begin(), ThisProgram().sections.end(),
      [this](const Section& section) {
        const bool needs = (section.flags & kPaperScene) != 0 ||
                           (!input_ && (section.flags & kScene) != 0);
        return needs && options.Wants(section.name);
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

void Run::FailForMemory(const std::string& why) const {
  throw UsageError("the scene of " + std::to_string(SceneObjects()) +
                   " objects takes " +
                   Mebibytes(SceneObjects() * sizeof(Aabo3)) + why +
                   "; choose fewer --objects");
}

const Workload& Run::Scene() {
  if (!scene_.objects.empty()) return scene_;
  try {
    scene_ = MakeScene(SceneObjects(),
                       options.queries != 0 ? options.queries : kTimedQueries,
                       options.seed);
    scene_.timed_queries = scene_.queries;
    if (options.queries == 0) scene_.queries.resize(kPaperQueries);
  } catch (const std::bad_alloc&) {
    FailForMemory(", which this program does not get");
  }
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
  for (const WorkingSetSize& size : Reached(names)) {
    sets.push_back(&Set(size));
  }
  return sets;
}

WorkingSet& Run::Set(const WorkingSetSize& size) {
  auto made = std::find_if(sets_.begin(), sets_.end(), [&](const auto& set) {
    return set->name() == size.name;
  });
  if (made == sets_.end()) {
    sets_.push_back(std::make_unique<WorkingSet>(Measured(), size));
    made = sets_.end() - 1;
  }
  return **made;
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
  if (options.exact_ns) {
    return {"given",
            Ratio{*options.exact_ns, *options.exact_ns, *options.exact_ns}};
  }
  if (!exact_test_) exact_test_ = MeasureExactTest(*this);
  return *exact_test_;
}

std::size_t Run::VerdictGroups() const {
  // An odd number has a median that is one of them.
  return options.repetitions == 0 ? kGroups
                                  : std::min(kGroups, options.repetitions | 1);
}

void Run::AddVerdictGroup() {
  if (!verdict_) verdict_ = std::make_unique<Verdict>(*this);
  if (verdict_->groups() < VerdictGroups()) verdict_->AddGroup(*this);
}

const Verdict& Run::TheVerdict() {
  while (!verdict_ || verdict_->groups() < VerdictGroups()) {
    progress.BeginPart(verdict_ ? verdict_->groups() : 0, VerdictGroups());
    AddVerdictGroup();
  }
  return *verdict_;
}

}  // namespace halfspace::bench
