// What disturbed the run.
#include <algorithm>
#include <cmath>

#include "bench/base/text.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"

namespace halfspace::bench {

Tables RunNoise(Run& run) {
  // Neither a busy neighbour nor a clock that changes by less has been seen to
  // change an answer.
  constexpr double kLimit = 0.05;
  run.Measured();
  std::vector<Case> cases;
  for (const char* name : {"noise/a", "noise/b"}) {
    cases.push_back(run.SmallSet().LibraryCase(
        name, ShapeKind::kSimplex,
        {.schedule = Schedule::kFlat, .target = run.best()}));
  }
  // Quartiles of a few repetitions say little.
  Effort effort = run.effort;
  effort.repetitions = std::max<std::size_t>(effort.repetitions, 9);
  const std::vector<Timing> timings = run.Time(cases, effort);
  const Ratio same = RatioOf(timings[0], timings[1]);
  run.clock().Sample();
  const double drift = run.clock().Drift();
  const double off = std::max(same.high - 1.0, 1.0 - same.low);
  const bool is_noisy = off > kLimit || drift > kLimit;
  Table table{"noise",
              "a kernel timed against itself, and the clock",
              {Key("what"), Value("value", "", 3)}};
  table.Add({"same over same", Cell(same)});
  table.Add({"clock, slowest over fastest", 1.0 + drift});
  table.Add({"run", is_noisy ? "noisy" : "quiet"});
  // Ranges between groups say how far the verdict is to be trusted; other
  // ratios have the quartiles of one group alone.
  table.notes = {
      "Trust counts always, the verdict within its ranges, and other ratios "
      "to " +
      std::string(std::max(off, drift) > 0.1 ? "one digit"
                  : is_noisy                 ? "a tenth"
                                             : "a twentieth") +
      (is_noisy ? ". Do not trust times: something disturbed the run."
       : run.machine.is_virtual
           ? ". Do not trust times: other virtual machines share the hardware."
           : ". Times can be trusted too.")};
  // --strict and the page need no more.
  if (run.is_page()) table.rows.erase(table.rows.begin(), table.rows.end() - 1);
  return {table};
}

}  // namespace halfspace::bench
