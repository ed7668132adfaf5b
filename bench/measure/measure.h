// Timing with Google Benchmark: cases registered in code, those that will be
// compared run close together and in random interleaving, so that a drifting
// machine drifts for all of them alike.
#ifndef HALFSPACE_BENCH_MEASURE_MEASURE_H_
#define HALFSPACE_BENCH_MEASURE_MEASURE_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace halfspace::bench {

// A benchmark whose answer was wrong before it was timed.
class WrongAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// One thing to time.
struct Case {
  std::string name = {};

  // Neighbours of the same group are interleaved with each other.
  std::string group = {};

  // What one run() works through, so that the time can be given for each:
  // objects times queries.
  double items = 1.0;

  // Calls of run() until all different queries have been used.
  std::size_t runs_of_all = 1;

  // Empty if the answers are right, else what is wrong. Called once, first.
  std::function<std::string()> check = {};

  std::function<void()> run = {};

  // Called after each repetition, and not timed. Such a case runs once a
  // repetition.
  std::function<void()> after = {};
};

// Nanoseconds per item, over the repetitions.
struct Timing {
  std::vector<double> samples;

  double Median() const { return Quantile(0.5); }
  double Quantile(double quantile) const;
};

// How one timing compares with another: median and quartiles of the ratios of
// their repetitions.
struct Ratio {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;

  Ratio Times(double factor) const {
    return {factor * median, factor * low, factor * high};
  }
};
Ratio RatioOf(const Timing& numerator, const Timing& denominator);
// The ratio of each pair of repetitions.
std::vector<double> RatiosOf(const Timing& numerator,
                             const Timing& denominator);

// Median and quartiles of a timing.
Ratio SpreadOf(const Timing& timing);

// Median, least and greatest of some values, at least one.
Ratio RangeOf(const std::vector<double>& values);

struct Effort {
  std::size_t repetitions = 5;
  double seconds_per_repetition = 0.01;
  // The repetitions together use every query of a case, however long that
  // takes.
  bool is_complete = false;
};

// Makes the compiler believe that a result is used.
void KeepResult(std::uint32_t result);

// Real time that run() takes once.
double SecondsOf(const std::function<void()>& run);

// Checks and times the cases, group by group. The timings are in the order of
// the cases. Throws WrongAnswer, naming the case.
std::vector<Timing> Measure(const std::vector<Case>& cases,
                            const Effort& effort);

// The check of a case: is_right(i) must hold for all i below `count`.
template <typename IsRight>
std::function<std::string()> CheckOf(std::size_t count, const char* wrong,
                                     IsRight is_right) {
  return [count, wrong, is_right = std::move(is_right)]() -> std::string {
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_right(i)) return std::to_string(i) + ": " + wrong;
    }
    return {};
  };
}

// A case that calls call(i) `per_run` times a run, for i = 0, 1, ... below
// `different`, and again. It is timed per call.
template <typename Call>
Case InTurn(std::size_t different, std::size_t per_run, Call call) {
  Case c;
  c.items = static_cast<double>(per_run);
  c.runs_of_all = (different + per_run - 1) / per_run;
  c.run = [different, per_run, call = std::move(call),
           next = std::size_t{0}]() mutable {
    for (std::size_t i = 0; i < per_run; ++i) {
      call(next);
      next = next + 1 == different ? 0 : next + 1;
    }
  };
  return c;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_MEASURE_H_
