// What a run lends its sections: worlds, timers, targets, and what more than
// one of them needs. All of it is made when it is first used.
#ifndef HALFSPACE_BENCH_SECTIONS_RUN_H_
#define HALFSPACE_BENCH_SECTIONS_RUN_H_

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/base/progress.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/measure/probes.h"
#include "bench/report/table.h"
#include "bench/sections/options.h"
#include "bench/sections/verdict.h"
#include "bench/worlds/working_set.h"
#include "bench/worlds/workload.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

inline constexpr std::size_t kPaperObjects = std::size_t{1} << 22;
inline constexpr std::size_t kPaperQueries = 128;

// What the progress line calls a group of the verdict, and the seconds that it
// takes on a common machine.
inline constexpr std::string_view kVerdictGroup = "simplex or box";
inline constexpr double kVerdictGroupSeconds = 3.0;

// What an exact test of a pair costs.
struct ExactTest {
  std::string name;
  double ns;
};

class Run {
 public:
  // `input` is the workload of a file, if one was given. Throws UsageError if
  // the scene is needed and does not fit the memory.
  Run(const BenchOptions& options, std::optional<Workload> input,
      Progress& progress);

  const BenchOptions& options;
  Progress& progress;
  Machine machine;
  std::vector<Target> targets;  // the best first
  Effort effort;
  // What other programs take, from the begin of the run on.
  LoadProbe load;
  ClockProbe clock;

  bool is_page() const { return options.details.empty(); }
  bool is_quick() const { return options.is_quick; }

  // The target that programs get, or the best that is measured.
  Target best() const;
  // In memory targets hardly differ, and take long: the best alone, and so if
  // the run is quick.
  std::vector<Target> TargetsIn(const std::string& set) const {
    return is_quick() || set == "memory" ? std::vector<Target>{best()}
                                         : targets;
  }

  // The workload of a file; null without one.
  const Workload* input() const { return input_ ? &*input_ : nullptr; }
  // The paper's scene.
  const Workload& Scene();
  // The workload of the file, or the scene.
  const Workload& Measured() { return input_ ? *input_ : Scene(); }
  std::size_t SceneObjects() const;
  // The most objects of other worlds: of a quick run fewer, and no more than
  // --objects.
  std::size_t MostObjects(std::size_t usual, std::size_t of_quick) const;

  // The working sets of these names, as far as they are reached.
  std::vector<WorkingSetSize> Reached(
      const std::vector<std::string>& names) const;
  std::vector<WorkingSet*> Sets(const std::vector<std::string>& names);
  // In L2, or of its usual size where there is none.
  WorkingSet& SmallSet();
  // A note for each working set that is not reached.
  std::vector<std::string> NotReached() const;

  // Those of --repetitions, or others.
  std::size_t RepetitionsOr(std::size_t usual) const {
    return options.repetitions == 0 ? usual : options.repetitions;
  }

  std::size_t AtMostRepetitions(std::size_t most) const {
    return std::min(effort.repetitions, most);
  }

  // That of --exact-ns, or of a pair of triangles.
  ExactTest TheExactTest();

  // Groups of the verdict: as many as repetitions, if these are given and
  // fewer.
  std::size_t VerdictGroups() const;
  // Simplex against box. The first call measures the groups that are missing.
  const Verdict& TheVerdict();
  // One more group of it, unless there are enough.
  void AddVerdictGroup();

  // What RunThreads() leaves for the answers.
  Table threads;

 private:
  bool NeedsScene() const;
  WorkingSet& Set(const WorkingSetSize& size);

  std::optional<Workload> input_;
  Workload scene_;
  std::optional<ExactTest> exact_test_;
  std::map<std::string, WorkingSet> sets_;
  std::unique_ptr<Verdict> verdict_;
};

// The list of sections of a program. A section measures or counts, and returns
// tables.
//
// Flags: the page has the section; it measures the scene, unless there is a
// file; or the scene in any case; it reads what other sections leave in Run; it
// reads the verdict.
inline constexpr unsigned kPage = 1;
inline constexpr unsigned kScene = 2;
inline constexpr unsigned kPaperScene = 4;
inline constexpr unsigned kLast = 8;
inline constexpr unsigned kVerdict = 16;

struct Section {
  std::string_view name;
  Tables (*run)(Run& run);
  double seconds;  // that it takes on a common machine, for the progress line
  unsigned flags;
};

// A program is this library and its list of sections.
struct Program {
  const char* name;
  const char* what;  // for --help
  std::span<const Section> sections;

  template <typename Is>
  bool HasAny(const Is& is) const {
    return std::any_of(sections.begin(), sections.end(), is);
  }
};

// The one that is linked: its sections.cc defines it.
const Program& ThisProgram();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_RUN_H_
