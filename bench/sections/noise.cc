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
  const Load load = run.LoadNow();
  const int cpus = run.machine.cores;
  const bool is_loaded = IsLoaded(load, cpus);
  const bool is_noisy = off > kLimit || drift > kLimit || is_loaded;
  Table table{"noise",
              "a kernel timed against itself, the clock, and other programs",
              {Key("what"), Value("value", "", 3)}};
  table.Add({"same over same", Cell(same)});
  table.Add({"clock, slowest over fastest", 1.0 + drift});
  table.Add({"share of the time with a CPU", load.cpu_share});
  table.Add({"interruptions per second", load.interruptions});
  table.Add({"CPUs that others took", Cell(load.others)});
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
  if (is_loaded) {
    table.notes.push_back(
        "Other programs took " +
        (load.others ? Fixed(*load.others, 1) + " of " + std::to_string(cpus)
                     : std::string("some")) +
        " CPUs, and interrupted this one " + Fixed(load.interruptions, 0) +
        " times a second. It had a CPU in " + Fixed(100.0 * load.cpu_share, 0) +
        " % of the time.");
  }
  // --strict and the page need no more.
  if (run.is_page()) table.rows.erase(table.rows.begin(), table.rows.end() - 1);
  return {table};
}

}  // namespace halfspace::bench
