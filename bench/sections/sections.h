// The sections of cpuinfo-bench that measure or count. Each fills its own
// result and nothing else.
#ifndef HALFSPACE_BENCH_SECTIONS_SECTIONS_H_
#define HALFSPACE_BENCH_SECTIONS_SECTIONS_H_

#include <vector>

#include "bench/base/progress.h"
#include "bench/measure/measure.h"
#include "bench/report/results.h"
#include "bench/worlds/working_set.h"
#include "bench/worlds/workload.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

// What the sections share.
struct Context {
  std::vector<Target> targets;  // those to measure
  Effort effort;
  Progress& progress;
  std::vector<Timing>& timings;  // collects everything that is timed
};

MachineResult RunMachine();

// Every target, shape and schedule against the scalar reference. Throws
// WrongAnswer.
CheckResult RunCheck(const Workload& workload, const Context& context);

// The paper's Table 1.
Table1Result RunTable1(const Workload& scene, std::uint64_t seed,
                       const Context& context);

// Gates of every width; `sets` holds L2 and, if it was reached, memory.
CrossoverResult RunCrossover(const std::vector<WorkingSet*>& sets,
                             const Context& context);

// Where the simplex begins to lead for good, from rows of one target and
// working set with ascending gates. Interpolated between two of them.
WStar FindWStar(const std::vector<CrossoverRow>& gated_rows);

// Every shape, target, schedule and working set, against reading the planes.
KernelsResult RunKernels(const std::vector<WorkingSet*>& sets,
                         const Context& context);

// Every bulk builder, target and size, against copying the same bytes; in
// memory, if it is to be quick, boxes alone.
BuildResult RunBuild(const Workload& workload,
                     const std::vector<WorkingSetSize>& sizes, bool is_quick,
                     const Context& context);

// Throughput of the calls against ceilings and baselines; `sets` holds L3 and
// memory, if they were reached. One threshold after the other.
ThroughputResult RunThroughput(const Workload& workload,
                               const std::vector<WorkingSet*>& sets,
                               const Machine& machine, std::uint64_t seed,
                               bool is_quick, const Context& context);

// Sorted worlds against trees and a scan, one workload after the other: of at
// most so many boxes, or as many as it sees fit for 0; and the boxes of
// `input`, a file, if there is one.
SortedResult RunSorted(const Workload* input, std::size_t most_objects,
                       std::uint64_t seed, bool is_quick,
                       const Context& context);

QualityResult RunQuality(const Workload& workload, const Context& context);

// What is kept of the objects along long segments, bounded whole and in pieces.
// Counts, and no times.
SegmentsResult RunSegments(const Workload& workload, std::uint64_t seed,
                           bool is_quick, const Context& context);

// Exact tests of pairs around each other, one test at a time.
std::vector<ExactTest> RunExactTests(std::uint64_t seed,
                                     const Context& context);

// The cost model on `set`, of the first target: predicted and measured.
ModelResult RunModel(const Workload& workload, WorkingSet& set,
                     const QualityResult& quality,
                     std::vector<ExactTest> exact_tests,
                     const Context& context);

// Every way to answer a query, over worlds of many sizes of objects and many
// objects, and on the workload; each with that exact test of its survivors.
SweepResult RunSweep(const Workload& workload, const ExactTest& exact,
                     std::uint64_t seed, bool is_quick, const Context& context);

// Scans that threads share, against one thread: in the cache, and of `memory`.
ThreadsResult RunThreads(const Workload& workload,
                         const std::vector<WorkingSet*>& memory,
                         const Context& context);

// A kernel against itself.
Ratio SameOverSame(WorkingSet& set, const Context& context);

// What to use, from what was measured; says what is missing.
AnswersResult MakeAnswers(const Results& results);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_SECTIONS_H_
