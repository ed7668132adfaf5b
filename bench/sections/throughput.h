// The parts of the section `throughput`: each threshold measures what it
// compares in one group, and adds rows and ratios.
#ifndef HALFSPACE_BENCH_SECTIONS_THROUGHPUT_H_
#define HALFSPACE_BENCH_SECTIONS_THROUGHPUT_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/report/results.h"
#include "bench/report/thresholds.h"
#include "bench/sections/plan.h"
#include "bench/sections/sections.h"
#include "bench/worlds/in_cache.h"
#include "bench/worlds/working_set.h"

namespace halfspace::bench {

// What a row is measured by, if it was timed with other cases.
struct Ceiling {
  enum class Kind { kRead, kReadQuantized, kRegisters };
  Kind kind;
  ShapeKind shape;
  std::string working_set;
  Target target;

  bool operator==(const Ceiling&) const = default;
};

class Throughput {
 public:
  // Of another section, its name is before those of all cases.
  Throughput(const Context& context, bool is_quick, ThroughputResult& result,
             std::string section = "throughput");

  // The widest measured target of each width that the thresholds speak of: of
  // x86 the best AVX-512, AVX2 and SSE4; elsewhere, and if it is to be quick,
  // the best.
  const std::vector<Target>& targets() const { return targets_; }
  bool is_quick() const { return is_quick_; }
  std::size_t repetitions() const { return context_.effort.repetitions; }
  Progress& progress() const { return context_.progress; }

  // Times cases as one group.
  Timings Time(std::vector<Case> cases);

  // The same for cases that take long, with fewer repetitions.
  Timings TimeLong(std::vector<Case> cases);

  // The same for many short cases, each for a fraction of the usual time.
  Timings TimeBriefly(std::vector<Case> cases);

  // The same for long runs, each of which is a repetition by itself.
  Timings TimeRuns(std::vector<Case> cases, std::size_t repetitions);

  // Adds what was timed in another way.
  void AddTimings(const Timings& timings);

  // The place of the row, for those that are measured by it.
  std::size_t AddRow(ThroughputRow row);

  // The same, for rows of later parts.
  std::size_t AddCeiling(const Ceiling& ceiling, ThroughputRow row);

  // A row that is measured by a ceiling; by none, if that was not timed.
  void AddRowUnder(const Ceiling& ceiling, ThroughputRow row);

  // The row of what was timed with all queries in turn, per pair, and another
  // of the same with kFewQueries, if three of four repetitions differ by more
  // than 3 %.
  enum class Rows { kAlways, kIfTheyDiffer };
  void AddRowsInTurn(const ThroughputRow& row, const Timing& all,
                     const Timing& few, Rows rows);

  void SetSurvivors(const PerShape<std::size_t>& survivors) {
    result_.survivors = survivors;
  }
  void NotReached(const std::string& reason) {
    result_.not_reached.push_back(reason);
  }

  // A value that has a threshold, for that target.
  void AddRatio(const Threshold& threshold, Target target, std::string name,
                double value) {
    result_.ratios.push_back({threshold.threshold, std::move(name), value,
                              threshold.For(target),
                              threshold.is_higher_better});
  }
  void AddRatio(const Threshold& threshold, Target target, std::string name,
                const Ratio& ratio) {
    AddRatio(threshold, target, std::move(name), ratio.median);
    result_.ratios.back().quartiles = ratio;
  }

 private:
  Timings TimeWith(const Effort& effort, std::vector<Case> cases);

  const Context& context_;
  bool is_quick_;
  ThroughputResult& result_;
  std::string section_;
  std::vector<Target> targets_;
  std::vector<std::pair<Ceiling, std::size_t>> ceilings_;  // and their rows
};

// Part of a threshold, for the progress line: run one after the other.
using ThroughputPart = std::function<void(Throughput&)>;
using ThroughputParts = std::vector<ThroughputPart>;
void RunParts(ThroughputParts& parts, Throughput& throughput);

// The fastest of some timings: the one with the smallest median.
std::size_t FastestOf(const Timings& timings,
                      const std::vector<std::size_t>& among);

// Thresholds 1 and 2: one query against its ceilings.
void AddCeilingParts(const Workload& workload, const Machine& machine,
                     const std::vector<WorkingSet*>& sets,
                     ThroughputParts& parts);

// Threshold 4, one query.
void AddQuantizedParts(const Workload& workload, const Machine& machine,
                       bool is_quick, ThroughputParts& parts);

// Thresholds 3, 4 and 5: many queries in the scene on a grid.
void AddManyParts(const Workload& workload, const Machine& machine,
                  std::uint64_t seed, bool is_quick, ThroughputParts& parts);

// Threshold 5, of the same scene.
class GridWorld;
void RunAgainstBaselines(const GridWorld& grid, Throughput& throughput);

// Thresholds 6 and 7: outputs, threads, sizes, and what a call costs.
void AddOutputParts(const Workload& workload, ThroughputParts& parts);
void AddSizeParts(const Workload& workload, const Machine& machine,
                  ThroughputParts& parts);

// Rows whose cost depends on branches, with few queries in turn and with many.
void AddQueryParts(const Workload& workload, ThroughputParts& parts);

// Threshold 8, if this program was built with the competitors.
void AddCompetitorParts(std::uint64_t seed, ThroughputParts& parts);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_THROUGHPUT_H_
