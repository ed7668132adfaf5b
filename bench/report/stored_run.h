// The report of an earlier run, which a new one is compared with.
#ifndef HALFSPACE_BENCH_REPORT_STORED_RUN_H_
#define HALFSPACE_BENCH_REPORT_STORED_RUN_H_

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bench/measure/measure.h"
#include "bench/report/results.h"

namespace halfspace::bench {

// How much worse a ratio must be than the spread of both runs explains: builds
// of the same sources differ by so much, as code lies elsewhere.
inline constexpr double kTolerance = 0.03;

struct StoredRatio {
  Ratio ratio;
  bool is_higher_better = true;
};

// A ratio is worse if the quartiles of both runs lie apart by more than
// kTolerance.
bool IsWorse(const StoredRatio& stored, const Ratio& now);

struct Regression {
  std::string section;
  std::string ratio;  // its name
  std::string text;   // the name, and both values
};

class StoredRun {
 public:
  // From a JSON report. Throws std::invalid_argument with what is wrong with
  // it.
  explicit StoredRun(std::string_view json);

  // Why a run of these says nothing against this one; empty if it does.
  std::string WhyIncomparable(const std::string& cpu,
                              const std::string& options) const;

  // The ratios that are worse, of those that both runs have, which `compared`
  // counts. Times are not compared: they are the machine's of the day.
  std::vector<Regression> RegressionsIn(const Results& results,
                                        std::size_t& compared) const;

 private:
  std::string cpu_;
  std::string options_;
  std::map<std::string, StoredRatio> ratios_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_STORED_RUN_H_
