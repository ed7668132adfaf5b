// Simplex or box: the one measurement of it, which all that mention it read.
#ifndef HALFSPACE_BENCH_SECTIONS_VERDICT_H_
#define HALFSPACE_BENCH_SECTIONS_VERDICT_H_

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "bench/base/shape.h"
#include "bench/measure/measure.h"
#include "bench/worlds/working_set.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

class Run;

// Groups are spread over the run. The range of their medians is the spread of
// an answer: it covers the difference between two runs, which the quartiles of
// one group do not.
inline constexpr std::size_t kVerdictGroups = 5;

enum class Winner { kSimplex, kBox, kNone };

// With the time of the box over the simplex's in each group. Nobody wins if 1
// lies in the range.
Winner WinnerOf(const Ratio& box_over_simplex);
const char* NameOf(Winner winner);

struct Contender {
  ShapeKind shape;
  const char* schedule;
  Schedule how;
};
inline constexpr std::array<Contender, 5> kContenders = {
    {{ShapeKind::kSimplex, "flat", Schedule::kFlat},
     {ShapeKind::kAabb, "flat", Schedule::kFlat},
     {ShapeKind::kAabb, "staged", Schedule::kStaged},
     {ShapeKind::kAabb, "by axis", Schedule::kStagedByAxis},
     {ShapeKind::kAabo, "staged", Schedule::kStaged}}};

// One world and target.
struct VerdictCell {
  // ns of an object in each group, of each contender.
  std::array<std::vector<double>, kContenders.size()> ns;

  // The contender of that shape with the lowest median.
  std::size_t BestOf(ShapeKind shape) const;
  Ratio Cost(ShapeKind shape) const { return RangeOf(ns[BestOf(shape)]); }
  Ratio Difference(ShapeKind more, ShapeKind less) const;
};

struct VerdictWorld {
  double percent = 0.0;  // of the world's side that an object takes; 0: a file
  std::size_t objects = 0;
  PerShape<double> survivors;      // of a query: kappa
  std::vector<VerdictCell> cells;  // of each target

  std::string name() const;
  // Of `shape` over the simplex, with that exact test.
  Ratio OverSimplex(ShapeKind shape, std::size_t target, double exact_ns) const;
};

class Verdict {
 public:
  explicit Verdict(Run& run);
  ~Verdict();

  void AddGroup(Run& run);

  std::size_t groups() const { return groups_; }
  const std::vector<Target>& targets() const { return targets_; }
  const std::vector<VerdictWorld>& worlds() const { return worlds_; }

 private:
  std::size_t groups_ = 0;
  std::vector<Target> targets_;
  std::vector<VerdictWorld> worlds_;
  std::deque<Workload> scenes_;
  std::vector<const Workload*> workloads_;  // of each world
  // New ones for each group, which stay: where a world lies in memory changes
  // its time by more than a group's repetitions do, and differs between runs.
  std::vector<std::unique_ptr<WorkingSet>> sets_;
  WorkingSetSize size_;
  Effort effort_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_VERDICT_H_
