// What each section found out: plain data, from which the text report, the JSON
// report and the answers are made.
#ifndef HALFSPACE_BENCH_REPORT_RESULTS_H_
#define HALFSPACE_BENCH_REPORT_RESULTS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure/cost_model.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/measure/work_count.h"
#include "bench/report/alternatives.h"
#include "bench/report/thresholds.h"

namespace halfspace::bench {

// One number for each shape.
template <typename T>
struct PerShape {
  T aabb{};
  T simplex{};
  T aabo{};
};

struct MachineResult {
  Machine machine;
  Build build;
  std::vector<std::string> compiled;
  std::vector<std::string> supported;
  std::string chosen;
  std::string why_chosen;
};

struct CheckResult {
  std::vector<std::string> targets;
  std::size_t objects = 0;
  std::size_t queries = 0;
  std::size_t masks = 0;  // how many were compared, bit for bit
};

struct Table1Result {
  std::size_t objects = 0;
  std::size_t queries = 0;
  std::uint64_t seed = 0;
  WorkCount work;
  PerShape<std::size_t> accepts;
};

// ns per object of each shape in one setting; a shape without that schedule
// has none.
struct CrossoverRow {
  std::string target;
  std::size_t lanes = 0;
  std::string working_set;
  std::string schedule;          // "every-plane", "flat", "staged", "by-axis"
  std::optional<std::size_t> w;  // the gate's width, for "every-plane"
  PerShape<std::optional<double>> ns;
  std::optional<Ratio> simplex_over_aabb;
};

struct WStar {
  std::string target;
  std::size_t lanes = 0;
  std::string working_set;
  std::optional<double> w_star;  // empty: no crossover
  bool is_at_most = false;  // the simplex led at the narrowest gate already
  // The same with the quartiles of all ratios.
  std::optional<double> low;
  std::optional<double> high;
};

struct CrossoverResult {
  std::vector<CrossoverRow> rows;
  std::vector<WStar> w_stars;
  std::vector<std::string> not_reached;  // working sets, with the reason
};

struct KernelRow {
  std::string shape;
  std::string target;
  std::string schedule;
  std::string working_set;
  std::size_t objects = 0;
  double ns_per_object = 0.0;
  double low = 0.0;  // quartiles
  double high = 0.0;
  double gigabytes_per_second = 0.0;  // of the shape's whole records
  Ratio percent_of_read;              // of reading the same bytes
};

struct KernelsResult {
  std::vector<KernelRow> rows;
  std::vector<std::string> not_reached;
};

struct BuildRow {
  std::string shapes;    // "boxes", "box-records", "spheres", ...
  std::string planes;    // "aabo" or "d"
  std::string rounding;  // "within-ulp" or "tightest"
  std::string target;
  std::string working_set;
  std::size_t objects = 0;
  std::string item;  // "object", or "point" of a set
  double ns_per_item = 0.0;
  double gigabytes_per_second = 0.0;  // read and written
  Ratio percent_of_copy;              // of copying the same bytes
  std::string copy;                   // the fastest way
  double copy_gigabytes_per_second = 0.0;
};

struct BuildThreshold {
  std::string target;
  double percent_of_copy = 0.0;

  bool is_met() const {
    return percent_of_copy >= thresholds::kBuildPercentOfCopy;
  }
};

// One shape at a time.
struct SingleBuildRow {
  std::string call;
  double ns_per_call = 0.0;
};

struct BuildResult {
  std::vector<BuildRow> rows;
  std::vector<SingleBuildRow> singles;
  std::vector<BuildThreshold> thresholds;  // none if memory was not reached
  std::vector<std::string> not_reached;
};

// One thing timed. A pair is an object and a query.
struct ThroughputRow {
  std::string name;
  std::size_t objects = 0;
  std::size_t queries = 0;
  std::string working_set;  // "L1", "L2", "L3", "memory", "grid", ...
  std::string target;       // empty: none of the library's
  double ns_per_pair = 0.0;
  std::optional<std::size_t> ceiling;  // the row that it is measured by
  std::optional<double> percent_of_ceiling;
};

// One aim of a threshold.
struct ThroughputRatio {
  int threshold = 0;
  std::string name;
  double value = 0.0;
  double needed = 0.0;
  bool is_higher_better = true;
  std::optional<Ratio> quartiles = std::nullopt;  // over repetitions

  bool is_met() const {
    return is_higher_better ? value >= needed : value <= needed;
  }
};

struct ThroughputResult {
  std::vector<ThroughputRow> rows;
  std::vector<ThroughputRatio> ratios;
  // Of the scene on a grid, the sum over all queries.
  std::optional<PerShape<std::size_t>> survivors;
  std::vector<std::string> not_reached;
};

// One way to answer box queries.
struct SortedRow {
  std::string name;
  std::string target;  // empty: none of the library's
  double ns = 0.0;     // a query, its queries in a row
  // In turns with all other rows, if that was asked.
  std::optional<double> ns_in_turns;
  // Times as fast as the fastest competitor; none without competitors.
  std::optional<double> over_fastest;
  std::optional<double> over_fastest_in_turns;
};

struct SortedWorkload {
  std::string name;  // "a", "clusters", "2D", "file"
  std::size_t objects = 0;
  double survivors = 0.0;  // of a query
  double blocks = 0.0;     // that it visits in tight order; 0: not counted
  std::vector<SortedRow> rows;
};

// What is done to all objects at once: a build, a refit, a join.
struct SortedJob {
  std::string name;
  std::size_t objects = 0;
  double ms = 0.0;
};

struct SortedResult {
  std::vector<SortedWorkload> workloads;
  std::vector<SortedJob> jobs;
  // Below so many objects a flat scan is faster, of floats or quantized; 0 if
  // it never is.
  std::optional<double> scan_is_faster_below;
  std::vector<ThroughputRatio> ratios;
  std::vector<std::string> remarks;
  std::vector<std::string> not_reached;
};

struct QualityResult {
  std::string workload;
  std::size_t objects = 0;
  std::size_t queries = 0;
  PerShape<std::size_t> survivors;
};

// Means over segments.
struct SegmentRow {
  std::string direction;  // "uniform", "(1,1,1)" or "(1,-1,0)"
  double length = 0.0;    // of the longest side of the box around all objects
  std::size_t pieces = 0;
  PerShape<double> kept;  // objects that a piece does not reject
  double floor = 0.0;     // aabo with a great many pieces
  std::size_t tests = 0;  // of an object and a piece, for one segment
};

struct SegmentsResult {
  std::string workload;
  std::size_t objects = 0;
  std::size_t segments = 0;  // of each direction and length
  std::uint64_t seed = 0;
  std::vector<SegmentRow> rows;
};

// What one test reads.
inline constexpr PerShape<std::size_t> kRecordBytes = {
    .aabb = 24, .simplex = 16, .aabo = 32};

// One shape, with an early-out after every half-space in batches of w.
struct ModelRow {
  std::size_t w = 0;
  double p = 0.0;             // that a half-space ends the batch
  double expected = 0.0;      // half-spaces, by p alone
  double counted = 0.0;       // half-spaces
  double compare_ns = 0.0;    // of an object, where nothing is rejected
  double predicted_ns = 0.0;  // of an object
  double measured_ns = 0.0;
  Ratio measured_over_predicted;
};

struct ModelShape {
  std::string shape;
  std::size_t planes = 0;
  std::string schedule;  // the fastest one of the library
  double ns_per_object = 0.0;
  std::vector<double> samples;  // of these, by repetition
  double candidates = 0.0;      // of all pairs
  std::vector<ModelRow> rows;
};

// The AABB's cost over the simplex's in batches of w, without exact tests.
struct AdvantageRow {
  std::size_t w = 0;
  double expected = 0.0;   // by half-spaces expected
  double counted = 0.0;    // by half-spaces counted
  double predicted = 0.0;  // by time predicted
  Ratio measured;
};

struct ExactTest {
  std::string name;
  double ns = 0.0;
  double low = 0.0;  // quartiles
  double high = 0.0;
};

// From which exact test on the simplex's extra candidates cost more than it
// saves.
struct BreakEven {
  std::string against;  // a shape
  std::optional<double> ns;
  double low = 0.0;  // quartiles
  double high = 0.0;
};

struct ModelResult {
  std::string target;
  std::string working_set;
  std::size_t objects = 0;
  double compare_ns = 0.0;  // w_cmp: of flat kernels, an object
  double call_ns = 0.0;     // kappa: what a call costs by itself
  std::vector<ModelShape> shapes;
  std::vector<AdvantageRow> advantages;
  LeadFrom expected;  // where the simplex begins to lead
  LeadFrom counted;
  LeadFrom predicted;
  LeadFrom measured;
  std::vector<ExactTest> exact_tests;
  std::vector<BreakEven> break_even;
};

// One way to answer a query with a list of survivors.
struct Way {
  std::string shape;
  std::string schedule;   // or "sorted"
  std::string precision;  // "floats", "uint8" or "uint16"
  double ns = 0.0;        // a query
  double low = 0.0;       // quartiles
  double high = 0.0;
  double survivors = 0.0;       // of a query
  double ns_with_exact = 0.0;   // a query, and the exact test of survivors
  std::vector<double> samples;  // ns with exact tests, by repetition
  Ratio of_best;                // its time over that of the best way

  // A sorted world tells by itself where it reads floats.
  std::string name() const {
    return shape + " " + schedule +
           (schedule == "sorted" ? "" : " " + precision);
  }
};

// A world, and every way to query it.
struct SweepCell {
  std::optional<double> size;  // of an object, of the world's side; of a file
                               // and of the paper's scene none
  std::size_t objects = 0;
  double slab_overlap = 0.0;  // share of pairs that overlap on X
  std::vector<Way> ways;
  std::size_t best = 0;  // of the ways
  bool is_tie = false;   // another way's quartiles reach the best's
};

// Time of gated scans, simplex over AABB.
struct MapPoint {
  std::size_t w = 0;
  double slab_overlap = 0.0;
  Ratio simplex_over_aabb;
};

struct SweepResult {
  std::string target;
  double exact_ns = 0.0;
  std::string exact_test;  // its name, or "given"
  SweepCell own;           // the scene, or the file
  std::vector<SweepCell> cells;
  std::vector<MapPoint> map;
};

struct ThreadsRow {
  std::string work;  // "one query, memory" or "many queries, cache"
  std::size_t threads = 0;
  double ns_per_pair = 0.0;
  Ratio times;  // as fast as one thread
};

struct ThreadsResult {
  std::vector<ThreadsRow> rows;
  std::vector<std::string> not_reached;
};

// What disturbed the run.
struct NoiseResult {
  Ratio same_over_same;      // one kernel timed against itself
  double clock_drift = 0.0;  // the slowest clock over the fastest, minus 1
  double limit = 0.0;        // of both, from which on a run is noisy

  bool is_noisy() const {
    return same_over_same.high - 1.0 > limit ||
           1.0 - same_over_same.low > limit || clock_drift > limit;
  }
};

struct Answer {
  std::string question;
  std::string text;
  Ratio times;  // as fast as the next best
  bool is_tie = false;
};

struct AnswersResult {
  std::vector<Answer> answers;
  std::vector<std::string> not_reached;
};

struct Results {
  MachineResult context;  // always known, whatever sections run
  std::string options;    // those that choose what is measured
  std::string command;    // all of them, as typed
  std::uint64_t seed = 0;
  std::size_t repetitions = 0;
  std::optional<MachineResult> machine;
  std::optional<CheckResult> check;
  std::optional<Table1Result> table1;
  std::optional<CrossoverResult> crossover;
  std::optional<KernelsResult> kernels;
  std::optional<BuildResult> build;
  std::optional<ThroughputResult> throughput;
  std::optional<SortedResult> sorted;
  std::optional<QualityResult> quality;
  std::optional<VolumesResult> volumes;
  std::optional<DualResult> dual;
  std::optional<AxesResult> axes;
  std::optional<SegmentsResult> segments;
  std::optional<ModelResult> model;
  std::optional<SweepResult> sweep;
  std::optional<ThreadsResult> threads;
  std::optional<NoiseResult> noise;
  std::optional<AnswersResult> answers;
  std::vector<Timing> timings;  // everything that was timed
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_RESULTS_H_
