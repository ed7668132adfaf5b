// What each section found out: plain data, from which the text report, the JSON
// report and the verdict are made.
#ifndef HALFSPACE_BENCH_REPORT_RESULTS_H_
#define HALFSPACE_BENCH_REPORT_RESULTS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/measure/work_count.h"
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

struct VerdictResult {
  std::array<std::string, 3> sentences;
};

struct Results {
  MachineResult context;  // always known, whatever sections run
  std::string options;    // those that choose what is measured
  std::optional<MachineResult> machine;
  std::optional<CheckResult> check;
  std::optional<Table1Result> table1;
  std::optional<CrossoverResult> crossover;
  std::optional<KernelsResult> kernels;
  std::optional<BuildResult> build;
  std::optional<ThroughputResult> throughput;
  std::optional<SortedResult> sorted;
  std::optional<QualityResult> quality;
  std::optional<SegmentsResult> segments;
  std::optional<VerdictResult> verdict;
  std::vector<Timing> timings;  // everything that was timed
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_RESULTS_H_
