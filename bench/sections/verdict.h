// Simplex or box: the one measurement of it, which all that mention it read.
#ifndef HALFSPACE_BENCH_SECTIONS_VERDICT_H_
#define HALFSPACE_BENCH_SECTIONS_VERDICT_H_

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/base/shape.h"
#include "bench/measure/groups.h"
#include "bench/measure/measure.h"
#include "bench/report/table.h"
#include "bench/worlds/working_set.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

class Run;

enum class Winner { kSimplex, kBox, kNone };

// With the time of the box over the simplex's in each group. Nobody wins if 1
// lies in the range.
Winner WinnerOf(const Ratio& box_over_simplex);
const char* NameOf(Winner winner);
// The ratio, with a mark for the winner.
Cell Marked(const Ratio& box_over_simplex);

struct Contender {
  ShapeKind shape;
  const char* schedule;
  Schedule how;
};

// Both bounds choose from equally many schedules.
inline constexpr std::array<Contender, 6> kContenders = {
    {{ShapeKind::kSimplex, "auto", Schedule::kAuto},
     {ShapeKind::kSimplex, "flat", Schedule::kFlat},
     {ShapeKind::kSimplex, "staged", Schedule::kStaged},
     {ShapeKind::kAabb, "auto", Schedule::kAuto},
     {ShapeKind::kAabb, "flat", Schedule::kFlat},
     {ShapeKind::kAabb, "staged", Schedule::kStaged}}};
inline constexpr std::size_t kFlatSimplex = 1;
inline constexpr std::size_t kFlatBox = 4;

// The time of the best of some contenders, whose repetitions are `samples`. The
// best is chosen in one half of the repetitions and timed in the other half,
// and the other way round: the best of several times of the same repetitions
// would be too short, and the more so the more contenders there are.
double BestTime(std::span<const std::vector<double>> samples);

// A target and the lanes of its vectors.
struct VerdictColumn {
  std::string name;  // "AVX2, 8", or "scalar"
  Target target;
};

// ns of an object in one group.
struct GroupTimes {
  std::vector<double> ns;  // of each contender
  double simplex = 0.0;    // of the best contender of each shape
  double box = 0.0;
};

struct VerdictWorld {
  double percent = 0.0;  // of the world's side that an object takes; 0: a file
  std::size_t objects = 0;
  // survivors[g] is the mean of a query in group g. times[column][group].
  std::vector<PerShape<double>> survivors = {};
  std::vector<std::vector<GroupTimes>> times = {};

  std::string name() const;
  // A time for each group.
  Timing TimingOf(std::size_t column, std::size_t contender) const;
  // Survivors of a query, the mean of the groups: kappa.
  PerShape<double> MeanSurvivors() const;
  // The times with that exact test.
  Ratio BoxOverSimplex(std::size_t column, double exact_ns) const;
};

// Ranges over the groups. Their ends are 0 and infinite as those of SizeSpan.
struct Crossings {
  Ratio from;
  Ratio to;
};

// What the first lines of the report say of a column: from which size on the
// simplex is faster, and from which the box again. `sizes` are those measured,
// in percent and ascending.
std::string SimplexText(const Crossings& crossings,
                        std::span<const double> sizes);
std::string BoxAgainText(const Crossings& crossings,
                         std::span<const double> sizes);
// The verdict of a file, which has objects of one kind.
std::string RatioText(const Ratio& box_over_simplex);

class Verdict {
 public:
  explicit Verdict(Run& run);

  void AddGroup(Run& run);

  std::size_t groups() const { return groups_; }
  // The narrowest first.
  const std::vector<VerdictColumn>& columns() const { return columns_; }
  // The one of the target that programs get. Of some of that target, the one
  // with the longest vectors.
  std::size_t best_column() const { return best_column_; }
  const std::vector<VerdictWorld>& worlds() const { return worlds_; }
  // The sizes of objects in the worlds, in percent.
  const std::vector<double>& sizes() const { return sizes_; }
  bool is_of_file() const { return sizes_.front() == 0.0; }
  // Where the simplex is faster; with exact tests of the best column alone.
  Crossings CrossingsOf(std::size_t column, bool with_exact) const;
  // Different queries in each cell.
  std::size_t queries() const { return queries_; }

 private:
  struct Place;
  using Spans = std::vector<std::vector<SizeSpan>>;  // of each column and group

  Place MakePlace(Run& run, double percent) const;
  GroupTimes TimePlace(Run& run, Place& place, std::size_t column,
                       const Effort& effort) const;
  void FindSpans(Run& run, std::map<double, Place>& places);

  std::size_t groups_ = 0;
  std::size_t queries_ = 0;
  std::size_t best_column_ = 0;
  std::vector<VerdictColumn> columns_;
  std::vector<double> sizes_;
  std::vector<VerdictWorld> worlds_;
  std::array<Spans, 2> spans_;  // without exact tests, and with them
  // Those of the rows are new in each group, and stay: where a world lies in
  // memory changes its time by more than a group's repetitions do, and differs
  // between runs.
  std::vector<std::unique_ptr<WorkingSet>> sets_;
  WorkingSetSize size_;
  Effort effort_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_VERDICT_H_
