// The parts of the section `throughput`, which `sorted` is built of too: each
// measures what it compares in one group, and adds rows and ratios.
#ifndef HALFSPACE_BENCH_SECTIONS_THROUGHPUT_H_
#define HALFSPACE_BENCH_SECTIONS_THROUGHPUT_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/sections/aims.h"
#include "bench/sections/run.h"
#include "bench/worlds/working_set.h"

namespace halfspace::bench {

// The timings of cases, by their place.
using Timings = std::vector<Timing>;

// One thing timed. A pair is an object and a query.
struct ThroughputRow {
  std::string name;
  std::size_t objects = 0;
  std::size_t queries = 0;
  std::string working_set;  // "L1", "L2", "L3", "memory", "grid", ...
  std::string target;       // empty: none of the library's
  double ns_per_pair = 0.0;
  std::string ceiling = {};  // the row that it is measured by
  std::optional<double> percent_of_ceiling = {};
};

class Throughput {
 public:
  // The name of the section is the beginning of the names of all cases.
  Throughput(Run& run, std::string section);

  // The best target of each width that has aims: AVX-512, AVX2 and SSE4.2 on
  // x86; the best one elsewhere, and if the run is quick.
  const std::vector<Target>& targets() const { return targets_; }
  bool is_quick() const { return run_.is_quick(); }
  std::size_t repetitions() const { return run_.effort.repetitions; }
  Progress& progress() const { return run_.progress; }

  // Times cases as one group.
  Timings Time(std::vector<Case> cases);

  // The same for cases that take long, with fewer repetitions.
  Timings TimeLong(std::vector<Case> cases);

  // The same for many short cases, each for a fraction of the usual time.
  Timings TimeBriefly(std::vector<Case> cases);

  // The same for long runs, each of which is a repetition by itself.
  Timings TimeRuns(std::vector<Case> cases, std::size_t repetitions);

  void AddRow(ThroughputRow row) { rows_.push_back(std::move(row)); }

  // A line below the tables.
  void AddNote(std::string note) { notes_.push_back(std::move(note)); }
  void NotReached(const std::string& reason) {
    AddNote("Not measured: " + reason + ".");
  }

  // A value that has an aim, for that target.
  void AddRatio(const Aim& aim, Target target, const std::string& name,
                const Cell& value);

  // Of the rows and of the aims.
  Table Rows() const;
  Table Aims() const;

 private:
  Timings TimeWith(const Effort& effort, std::vector<Case> cases);

  Run& run_;
  std::string section_;
  std::vector<Target> targets_;
  std::vector<ThroughputRow> rows_;
  std::vector<Row> aims_;
  std::vector<std::string> notes_;
};

// For the progress line: run one after the other.
using ThroughputPart = std::function<void(Throughput&)>;
using ThroughputParts = std::vector<ThroughputPart>;
void RunParts(ThroughputParts& parts, Throughput& throughput);

// The fastest of some timings: the one with the smallest median.
std::size_t FastestOf(const Timings& timings,
                      const std::vector<std::size_t>& among);

// One query against reading its planes, and what a call costs by itself.
void AddCeilingParts(const std::vector<WorkingSet*>& sets,
                     ThroughputParts& parts);
void AddCallParts(const Workload& workload, ThroughputParts& parts);

// One query, quantized.
void AddQuantizedParts(const Workload& workload, const Machine& machine,
                       bool is_quick, ThroughputParts& parts);

// Many queries in the scene on a grid: against the same in the first-level
// cache, and against the loops that one would write instead.
void AddManyParts(const Workload& workload, const Machine& machine,
                  std::uint64_t seed, bool is_quick, ThroughputParts& parts);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_THROUGHPUT_H_
