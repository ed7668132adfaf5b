#include "bench/app/run.h"

#include <algorithm>
#include <memory>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/base/write_whole.h"
#include "bench/measure/clock_probe.h"
#include "bench/report/paper.h"
#include "bench/report/report.h"
#include "bench/sections/alternatives.h"
#include "bench/sections/sections.h"
#include "bench/worlds/scene.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kQuickObjects = std::size_t{1} << 19;

std::vector<Target> TargetsOf(const BenchOptions& options) {
  if (!options.target.empty()) return {TargetByName(options.target)};
  const std::span<const Target> all = SupportedTargets();
  return {all.begin(), all.end()};
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

// The sections of one run, with what they share made when first needed.
class Runner {
 public:
  Runner(const BenchOptions& options, std::optional<Workload> input,
         Progress& progress, std::ostream* text)
      : options_(options),
        input_(std::move(input)),
        progress_(progress),
        text_(text),
        context_{TargetsOf(options), EffortOf(options), progress,
                 results_.timings},
        best_{context_} {
    // SupportedTargets() is best first, and answers are about one target.
    best_.targets = {AnswersTarget()};
  }

  Results Run() {
    results_.context = RunMachine();
    results_.options = options_.Scope();
    results_.command = options_.command;
    results_.seed = options_.seed;
    results_.repetitions = context_.effort.repetitions;
    CheckMemory();
    PlanProgress();
    Section("machine", results_.machine, [&] { return results_.context; });
    Section("check", results_.check,
            [&] { return RunCheck(Measured(), context_); });
    Section("table1", results_.table1,
            [&] { return RunTable1(Scene(), options_.seed, context_); });
    Section("crossover", results_.crossover, [&] {
      CrossoverResult result = RunCrossover(
          IsPage() ? Sets({"L2"}) : Sets({"L2", "memory"}), context_);
      result.not_reached = NotReached();
      return result;
    });
    Section("kernels", results_.kernels, [&] {
      KernelsResult result = RunKernels(Sets({"L1", "L2", "L3", "memory"}),
                                        IsPage() ? best_ : context_);
      result.not_reached = NotReached();
      return result;
    });
    Section("build", results_.build, [&] {
      BuildResult result = RunBuild(Measured(), Reached({"L2", "memory"}),
                                    options_.is_quick, context_);
      result.not_reached = NotReached();
      return result;
    });
    Section("throughput", results_.throughput, [&] {
      ThroughputResult result = RunThroughput(
          Measured(), Sets({"L3", "memory"}), results_.context.machine,
          options_.seed, options_.is_quick, context_);
      const std::vector<std::string> more = NotReached();
      result.not_reached.insert(result.not_reached.end(), more.begin(),
                                more.end());
      return result;
    });
    Section("sorted", results_.sorted, [&] {
      return RunSorted(input_ ? &*input_ : nullptr, options_.objects,
                       options_.seed, options_.is_quick, context_);
    });
    Section("quality", results_.quality,
            [&] { return RunQuality(Measured(), context_); });
    Section("volumes", results_.volumes, [&] {
      VolumesResult result =
          RunVolumes(input_ ? &*input_ : nullptr, options_.objects,
                     Reached({"L2", "memory"}), options_.seed,
                     options_.is_quick, context_);
      result.not_reached = NotReached();
      return result;
    });
    Section("dual", results_.dual, [&] {
      DualResult result =
          RunDual(Measured(), Sets({"L2", "memory"}), Reached({"L2", "memory"}),
                  options_.is_quick, context_);
      result.not_reached = NotReached();
      return result;
    });
    Section("axes", results_.axes, [&] {
      return RunAxes(input_ ? &*input_ : nullptr, options_.seed, context_);
    });
    Section("segments", results_.segments, [&] {
      return RunSegments(Measured(), options_.seed, options_.is_quick,
                         context_);
    });
    Section("model", results_.model, [&] {
      return RunModel(Measured(), SmallSet(), Quality(), ExactTests(), best_);
    });
    Section("sweep", results_.sweep, [&] {
      const ExactTest exact =
          options_.exact_ns ? ExactTest{"given", *options_.exact_ns,
                                        *options_.exact_ns, *options_.exact_ns}
                            : ExactTests().front();
      return RunSweep(Measured(), exact, options_.seed, options_.is_quick,
                      best_);
    });
    Section("threads", results_.threads,
            [&] { return RunThreads(Measured(), Sets({"memory"}), best_); });
    Section("noise", results_.noise, [&] { return Noise(); });
    Section("answers", results_.answers, [&] { return MakeAnswers(results_); });
    return std::move(results_);
  }

 private:
  // Seconds that each section takes on a common machine, in proportion.
  static double WeightOf(std::string_view section) {
    if (section == "scene") return 4.0;
    if (section == "check") return 1.0;
    if (section == "table1") return 5.0;
    if (section == "crossover") return 45.0;
    if (section == "kernels") return 25.0;
    if (section == "build") return 15.0;
    if (section == "throughput") return 70.0;
    if (section == "sorted") return 50.0;
    if (section == "volumes") return 10.0;
    if (section == "dual") return 5.0;
    if (section == "axes") return 2.0;
    if (section == "segments") return 1.0;
    if (section == "model") return 2.0;
    if (section == "sweep") return 15.0;
    if (section == "threads") return 2.0;
    return 0.1;
  }

  void PlanProgress() {
    double total = WeightOf("scene");
    for (std::string_view section : kSections) {
      if (options_.Wants(section)) total += WeightOf(section);
    }
    progress_.Plan(total);
  }

  template <typename Result, typename MakeResult>
  void Section(const char* name, std::optional<Result>& result,
               const MakeResult& make) {
    if (!options_.Wants(name)) return;
    if (scene_.objects.empty() && NeedsScene(name)) Scene();
    progress_.Begin(name, WeightOf(name));
    clock_.Sample();
    try {
      result = make();
      progress_.Clear();
      if (text_ != nullptr) {
        WriteWhole(*text_, [&](std::ostream& out) {
          if (is_first_) WriteHead(out);
          WriteText(out, *result);
        });
        is_first_ = false;
      }
    } catch (const std::bad_alloc&) {
      FailForMemory(std::string("the section ") + name);
    }
  }

  void WriteHead(std::ostream& out) const {
    out << "cpuinfo-bench " << results_.context.build.version << ' '
        << Printable(options_.command) << "\n"
        << results_.context.machine.cpu << ", seed " << options_.seed
        << ", medians of " << context_.effort.repetitions << " repetitions\n";
  }

  bool NeedsScene(std::string_view section) const {
    if (section == "table1") return true;
    return !input_ && section != "machine" && section != "sorted" &&
           section != "volumes" && section != "axes" && section != "answers";
  }

  std::size_t SceneObjects() const {
    if (options_.objects != 0) return options_.objects;
    return options_.is_quick ? kQuickObjects : kPaperObjects;
  }

  std::string SceneText() const {
    return "the scene of " + std::to_string(SceneObjects()) +
           " objects, which takes " + Mebibytes(SceneObjects() * sizeof(Aabo3));
  }

  [[noreturn]] static void FailForMemory(const std::string& what) {
    throw std::runtime_error(
        "not enough memory for " + what +
        "; free some, or choose --quick, fewer --objects or fewer "
        "sections by --details");
  }

  // Before anything is taken: a system that has promised too much ends the
  // program without a word. An eighth is left to the sections.
  void CheckMemory() const {
    const bool is_needed = std::any_of(
        kSections.begin(), kSections.end(), [this](std::string_view section) {
          return options_.Wants(section) && NeedsScene(section);
        });
    const std::size_t available = results_.context.machine.available_memory;
    if (is_needed && available != 0 &&
        SceneObjects() * sizeof(Aabo3) > available / 8 * 7) {
      throw UsageError("not enough memory for " + SceneText() + ": " +
                       Mebibytes(available) +
                       " are free; choose fewer --objects");
    }
  }

  const Workload& Scene() {
    if (!scene_.objects.empty()) return scene_;
    progress_.Begin("scene", WeightOf("scene"));
    try {
      scene_ = MakeScene(
          SceneObjects(),
          options_.queries != 0 ? options_.queries : kTimedQueries,
          options_.seed, [&](double done) { progress_.Update(done); });
      scene_.timed_queries = scene_.queries;
      if (options_.queries == 0) scene_.queries.resize(kPaperQueries);
    } catch (const std::bad_alloc&) {
      FailForMemory(SceneText());
    }
    // What the working sets may still take.
    results_.context.machine.available_memory = FreeMemory();
    return scene_;
  }

  // What is measured: the file, else the scene.
  const Workload& Measured() { return input_ ? *input_ : Scene(); }

  // The sizes of these names, as far as they are reached.
  std::vector<WorkingSetSize> Reached(
      const std::vector<std::string>& names) const {
    std::vector<WorkingSetSize> sizes;
    for (const WorkingSetSize& size :
         WorkingSetSizes(results_.context.machine)) {
      if (size.why_not_reached.empty() &&
          std::find(names.begin(), names.end(), size.name) != names.end()) {
        sizes.push_back(size);
      }
    }
    return sizes;
  }

  std::vector<WorkingSet*> Sets(const std::vector<std::string>& names) {
    std::vector<WorkingSet*> sets;
    for (const WorkingSetSize& size : Reached(names)) {
      sets.push_back(&Set(size));
    }
    return sets;
  }

  WorkingSet& Set(const WorkingSetSize& size) {
    auto made = std::find_if(sets_.begin(), sets_.end(), [&](const auto& set) {
      return set->name() == size.name;
    });
    if (made == sets_.end()) {
      sets_.push_back(std::make_unique<WorkingSet>(Measured(), size));
      made = sets_.end() - 1;
    }
    return **made;
  }

  // That of L2, or of its usual size where there is none.
  WorkingSet& SmallSet() {
    return Set(WorkingSetSizes(results_.context.machine)[1]);
  }

  std::vector<std::string> NotReached() const {
    std::vector<std::string> reasons;
    for (const WorkingSetSize& size :
         WorkingSetSizes(results_.context.machine)) {
      if (!size.why_not_reached.empty()) {
        reasons.push_back(size.name + ": " + size.why_not_reached);
      }
    }
    return reasons;
  }

  bool IsPage() const { return options_.details.empty(); }

  const QualityResult& Quality() {
    if (results_.quality) return *results_.quality;
    if (!quality_) quality_ = RunQuality(Measured(), context_);
    return *quality_;
  }

  const std::vector<ExactTest>& ExactTests() {
    if (exact_tests_.empty()) {
      exact_tests_ = RunExactTests(options_.seed, context_);
    }
    return exact_tests_;
  }

  NoiseResult Noise() {
    // Neither a busy neighbour nor a clock that changes by less has been seen
    // to change an answer.
    constexpr double kLimit = 0.05;
    const Ratio ratio = SameOverSame(SmallSet(), best_);
    clock_.Sample();
    return {ratio, clock_.Drift(), kLimit};
  }

  Target AnswersTarget() const {
    const std::vector<Target>& targets = context_.targets;
    const bool is_measured = std::find(targets.begin(), targets.end(),
                                       ChosenTarget()) != targets.end();
    return is_measured ? ChosenTarget() : targets.front();
  }

  const BenchOptions& options_;
  std::optional<Workload> input_;
  Progress& progress_;
  std::ostream* text_;
  bool is_first_ = true;  // nothing is written to it yet
  Results results_;
  Context context_;
  Context best_;  // the target of the answers alone
  Workload scene_;
  ClockProbe clock_;
  std::optional<QualityResult> quality_;  // if its section does not run
  std::vector<ExactTest> exact_tests_;
  std::vector<std::unique_ptr<WorkingSet>> sets_;
};

}  // namespace

std::string BenchOptions::Scope() const {
  std::string text;
  const auto add = [&text](const std::string& option) {
    text += (text.empty() ? "" : " ") + option;
  };
  if (is_quick) add("--quick");
  if (!mesh.empty()) add("--mesh " + mesh);
  if (!bounds.empty()) add("--bounds " + bounds);
  if (!query_bounds.empty()) add("--query-bounds " + query_bounds);
  if (query_size != 0) {
    std::ostringstream size;
    size << query_size;
    add("--query-size " + size.str());
  }
  if (objects != 0) add("--objects " + std::to_string(objects));
  if (queries != 0) add("--queries " + std::to_string(queries));
  if (seed != 1) add("--seed " + std::to_string(seed));
  if (exact_ns) add("--exact-ns " + Fixed(*exact_ns, 3));
  return text;
}

Results Run(const BenchOptions& options, std::optional<Workload> input,
            Progress& progress, std::ostream* text) {
  return Runner(options, std::move(input), progress, text).Run();
}

}  // namespace halfspace::bench
