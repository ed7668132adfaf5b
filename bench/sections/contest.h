// Contestants that answer the same questions, timed beside each other, and the
// rows that they become. Each answer is checked before it is timed.
#ifndef HALFSPACE_BENCH_SECTIONS_CONTEST_H_
#define HALFSPACE_BENCH_SECTIONS_CONTEST_H_

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/report/table.h"
#include "bench/sections/run.h"

namespace halfspace::bench {

// The fastest of the competitors or limits is what the others are compared
// with. A limit has no row.
enum class Who { kOurs, kCompetitor, kLimit };

class Contest {
 public:
  // The names of all cases begin with `place`. They are one group.
  Contest(Run& run, std::string place) : run_(run), place_(std::move(place)) {}

  // `keys` name the case, and are the first cells of its row.
  void Add(Row keys, Case c, Who who = Who::kOurs);

  void Time() { Time(run_.effort); }
  void Time(std::size_t repetitions) {
    Time({repetitions, run_.effort.seconds_per_repetition});
  }
  // Each call of run() is a repetition.
  void TimeOnce(std::size_t repetitions) { Time({repetitions, 0.0}); }
  void Time(const Effort& effort);

  // In the order in which they were added.
  std::size_t size() const { return cases_.size(); }
  const Row& keys(std::size_t i) const { return keys_[i]; }
  const Timing& timing(std::size_t i) const { return timings_[i]; }
  double Median(std::size_t i) const { return timings_[i].Median(); }
  const Timing& fastest() const { return timings_[fastest_]; }
  // How many times as fast as the fastest; empty without competitors.
  Cell OverFastest(std::size_t i) const {
    if (fastest_ == cases_.size()) return {};
    return RatioOf(fastest(), timings_[i]);
  }

  // Adds the rows: after the keys comes the spread, or values(i).
  void AddTo(Table& table) const {
    AddTo(table, [&](std::size_t i) -> Row { return {SpreadOf(timing(i))}; });
  }
  template <typename Values>
  void AddTo(Table& table, Values values) const {
    for (std::size_t i = 0; i < size(); ++i) {
      if (whose_[i] == Who::kLimit) continue;
      Row row = keys_[i];
      for (Cell& cell : values(i)) row.push_back(std::move(cell));
      table.Add(std::move(row));
    }
  }

 private:
  Run& run_;
  std::string place_;
  std::vector<Row> keys_;
  std::vector<Case> cases_;
  std::vector<Who> whose_;
  std::vector<Timing> timings_;
  std::size_t fastest_ = 0;  // size() without competitors
};

// The sizes up to `most`; if none, that one.
std::vector<std::size_t> UpTo(std::size_t most, std::vector<std::size_t> sizes);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_CONTEST_H_
