// What a section times, and the rows that it fills by that.
#ifndef HALFSPACE_BENCH_SECTIONS_PLAN_H_
#define HALFSPACE_BENCH_SECTIONS_PLAN_H_

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

// The timings of cases, by their place.
using Timings = std::vector<Timing>;

// Times cases, and keeps the timings for the report.
inline Timings TimeCases(const std::vector<Case>& cases, const Effort& effort,
                         const Context& context) {
  Timings timings = Measure(cases, effort, context.progress);
  context.timings.insert(context.timings.end(), timings.begin(), timings.end());
  return timings;
}

// A row is planned before anything is timed, as all cases are timed together.
template <typename Row>
class Plan {
 public:
  using Fill = std::function<void(const Timings& timings, Row& row)>;

  // The place of its timing.
  std::size_t AddCase(Case c) {
    cases_.push_back(std::move(c));
    return cases_.size() - 1;
  }

  void AddRow(Row row, Fill fill) {
    rows_.push_back({std::move(row), std::move(fill)});
  }

  std::size_t rows() const { return rows_.size(); }

  // Times all cases, and appends the rows in their order.
  void Run(const Effort& effort, const Context& context,
           std::vector<Row>& rows) {
    const Timings timings = TimeCases(cases_, effort, context);
    for (auto& [row, fill] : rows_) {
      fill(timings, row);
      rows.push_back(std::move(row));
    }
  }

 private:
  std::vector<Case> cases_;
  std::vector<std::pair<Row, Fill>> rows_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_SECTIONS_PLAN_H_
