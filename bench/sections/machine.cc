// What the machine is, and what disturbed the run.
#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "bench/base/text.h"
#include "bench/sections/contest.h"

namespace halfspace::bench {
namespace {

// With Highway's name where that differs.
std::string NamesOf(std::span<const Target> targets) {
  std::string names;
  for (Target target : targets) {
    if (!names.empty()) names += ", ";
    names += NameOf(target);
    if (NameOf(target) != target.name()) {
      names += " (" + std::string(target.name()) + ")";
    }
  }
  return names;
}

}  // namespace

Tables RunMachine(Run& run) {
  const Machine& machine = run.machine;
  const TargetChoice choice = DescribeTargetChoice();
  const Build build = DescribeBuild();
  std::string isa;
  for (const std::string& name : machine.isa) isa += name + " ";
  Table table{"machine", machine.cpu, {Key("what"), Value("value")}};
  table.rows = {
      {"model", machine.Model()},
      {"system", machine.system + ", " + machine.architecture},
      {"cores", std::to_string(machine.cores) + ", of which this run may use " +
                    std::to_string(UsableCpus())},
      {"caches", machine.CachesText()},
      {"extensions", isa},
      {"compiled", NamesOf(CompiledTargets())},
      {"supported", NamesOf(SupportedTargets())},
      {"chosen", NameOf(choice.target) +
                     (choice.requested.empty()
                          ? ", the best that is compiled and supported"
                          : ", which HALFSPACE_TARGET or --target asks for")},
      {"built by", build.compiler + ", " + build.type + ", Highway " +
                       build.highway + ", " + build.flags}};
  if (build.type != "release") {
    table.notes.push_back("Warning: a debug build. Its times mean nothing.");
  }
  if (machine.is_virtual) {
    table.notes.push_back(
        "This is a virtual machine. Others share its hardware, so trust "
        "counts, and ratios within their ranges, but not times.");
  }
  if (machine.is_emulated) {
    table.notes.push_back(
        "The CPU is emulated. Only counts mean anything, and there are no "
        "answers.");
  }
  return {table};
}

Tables RunNoise(Run& run) {
  // Neither a busy neighbour nor a clock that changes by less has been seen to
  // change an answer.
  constexpr double kLimit = 0.05;
  run.Measured();
  const Case kernel = run.SmallSet().LibraryCase(
      ShapeKind::kSimplex, {.schedule = Schedule::kFlat, .target = run.best()});
  Contest contest(run, "noise");
  contest.Add({"first"}, kernel);
  contest.Add({"second"}, kernel);
  // Quartiles of a few repetitions say little.
  contest.Time(std::max<std::size_t>(run.effort.repetitions, 9));
  const Ratio same = RatioOf(contest.timing(0), contest.timing(1));
  run.clock.Sample();
  const double drift = run.clock.Drift();
  const double off = std::max(same.high - 1.0, 1.0 - same.low);
  const Load load = run.load.Sample();
  const int cpus = run.machine.cores;
  const bool is_loaded = IsLoaded(load, cpus);
  // A quiet machine can time its threads.
  const bool are_threads_missing =
      std::any_of(run.threads.rows.begin(), run.threads.rows.end(),
                  [](const Row& row) { return !row[2].value; });
  const bool is_noisy =
      off > kLimit || drift > kLimit || is_loaded || are_threads_missing;
  Table table{"noise",
              "a kernel timed against itself, the clock, and other programs",
              {Key("what"), Value("value", "", 3)}};
  table.rows = {{"same over same", same},
                {"clock, slowest over fastest", 1.0 + drift},
                {"share of the time with a CPU", load.cpu_share},
                {"interruptions per second", load.interruptions},
                {"CPUs that others took", load.others},
                {"run", is_noisy ? "noisy" : "quiet"}};
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
  if (run.is_page()) table.rows = {table.rows.back()};
  return {table};
}

}  // namespace halfspace::bench
