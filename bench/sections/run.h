// A run of the program. It has the worlds, timers and targets that sections
// share, and makes each when it is first used.
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

// The verdict is measured in groups, which are spread over the run
// (measure/groups.h). This is the name of a group in the progress line, and the
// seconds that it takes on a common machine.
inline constexpr std::string_view kVerdictGroup = "simplex or box";
inline constexpr double kVerdictGroupSeconds = 3.0;

// The time of an exact test of a pair.
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

  // The target that programs get, or the best that is measured.
  Target best() const;
  // The targets to measure in a working set. In memory, targets hardly differ
  // and take long, so it is the best one alone. The same holds for a quick run.
  std::vector<Target> TargetsIn(const std::string& set) const {
    return options.is_quick || set == "memory" ? std::vector<Target>{best()}
                                               : targets;
  }

  // The workload of a file; null without one.
  const Workload* input() const { return input_ ? &*input_ : nullptr; }
  // The paper's scene.
  const Workload& Scene();
  // The workload of the file, or the scene.
  const Workload& Measured() { return input_ ? *input_ : Scene(); }
  std::size_t SceneObjects() const;
  // The most objects of other worlds: `usual`, or `of_quick` in a quick run,
  // but no more than --objects.
  std::size_t MostObjects(std::size_t usual, std::size_t of_quick) const;

  // The sizes of these names that this machine reaches.
  std::vector<WorkingSetSize> Reached(
      const std::vector<std::string>& names) const;
  std::vector<WorkingSet*> Sets(const std::vector<std::string>& names);
  // The working set in L2, or of the usual size of an L2 if there is none.
  WorkingSet& SmallSet();
  // A note for each working set that is not reached.
  std::vector<std::string> NotReached() const;

  // The number of --repetitions, or `usual` if it is not given.
  std::size_t RepetitionsOr(std::size_t usual) const {
    return options.repetitions == 0 ? usual : options.repetitions;
  }

  std::size_t AtMostRepetitions(std::size_t most) const {
    return std::min(effort.repetitions, most);
  }

  // The time of --exact-ns, or of a pair of triangles, which is measured.
  ExactTest TheExactTest();

  // The number of groups of the verdict: kGroups, or the number of repetitions
  // if that is given and less.
  std::size_t VerdictGroups() const;
  // Simplex against box. Measures the groups that are missing.
  const Verdict& TheVerdict();
  // Measures one more group of the verdict, unless there are VerdictGroups().
  void AddVerdictGroup();

  // Set by RunThreads(), for sections that run after it.
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

// Flags of a section.
inline constexpr unsigned kPage = 1;        // is on the page
inline constexpr unsigned kScene = 2;       // measures the file, or the scene
inline constexpr unsigned kPaperScene = 4;  // always measures the scene
inline constexpr unsigned kLast = 8;        // runs after all others
inline constexpr unsigned kVerdict = 16;    // reads the verdict

// A section measures or counts, and returns tables.
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

// The program that is linked. sections.cc defines it.
const Program& ThisProgram();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_RUN_H_
