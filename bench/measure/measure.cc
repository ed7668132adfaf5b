#include "bench/measure/measure.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace halfspace::bench {
namespace {

double QuantileOf(std::vector<double> values, double quantile) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = quantile * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  const double part = at - static_cast<double>(below);
  return values[below] * (1.0 - part) + values[above] * part;
}

// What the clock can measure. Browsers' clocks have steps of 0.1 ms, or of 1
// ms, of which ten would take a minute too long.
double ShortestTiming() {
  static const double least = [] {
    double step = 1.0;
    for (int i = 0; i < 4; ++i) {  // the first ends at a step
      double taken = 0.0;
      const auto start = std::chrono::steady_clock::now();
      while (taken == 0.0) {
        taken = std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                              start)
                    .count();
      }
      if (i > 0) step = std::min(step, taken);
    }
    return std::min(10.0 * step, 0.001 + 1.5 * step);
  }();
  return least;
}

// How many calls a repetition has, fixed before the timing, so that the time of
// the whole run can be estimated. The first call is cold. A few calls more are
// timed together, because one of them may take less than a step of the clock. A
// case with after() has one call.
std::size_t CallsPerRepetition(const Case& c, const Effort& effort) {
  const double seconds =
      std::max(effort.seconds_per_repetition, ShortestTiming());
  std::size_t least = 1;
  if (effort.is_complete) {
    least = (c.runs_of_all + effort.repetitions - 1) / effort.repetitions;
  }
  const double first = SecondsOf(c.run);
  if (c.after) {
    c.after();
    return 1;
  }
  if (first > 4.0 * seconds) return least;
  constexpr std::size_t kMost = std::size_t{1} << 30;
  const auto seconds_of = [&c](std::size_t calls) {
    return SecondsOf([&] {
      for (std::size_t i = 0; i < calls; ++i) c.run();
    });
  };
  // The lesser of two times, because an interruption would leave too few calls.
  std::size_t calls = 1;
  double taken = seconds_of(calls);
  if (taken < seconds) taken = std::min(taken, seconds_of(calls));
  while (taken < seconds / 8 && calls < kMost) {
    calls *= 4;
    taken = std::min(seconds_of(calls), seconds_of(calls));
  }
  const double once = std::max(taken / static_cast<double>(calls), 1e-9);
  return std::max(least, static_cast<std::size_t>(
                             std::clamp(std::ceil(seconds / once), 1.0, 1e9)));
}

// Collects the repetitions; the name of each benchmark is the case's index.
class Collector : public benchmark::BenchmarkReporter {
 public:
  Collector(const std::vector<Case>& cases, std::vector<Timing>& timings)
      : cases_(cases), timings_(timings) {}

  bool ReportContext(const Context& /*context*/) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      const std::size_t index = std::stoul(run.run_name.function_name);
      // CPU time of this thread: a kernel never waits, and real time would
      // count the other programs of a busy machine. Windows counts CPU time in
      // steps of 16 ms.
#if defined(_WIN32)
      const double seconds = run.real_accumulated_time;
#else
      const double seconds = run.cpu_accumulated_time;
#endif
      timings_[index].samples.push_back(
          seconds * 1e9 /
          (static_cast<double>(run.iterations) * cases_[index].items));
    }
  }

 private:
  const std::vector<Case>& cases_;
  std::vector<Timing>& timings_;
};

// Google Benchmark takes its settings from a command line only.
void InitializeOnce() {
  static const bool initialized = [] {
    std::array<std::string, 3> words = {
        "cpuinfo-bench", "--benchmark_enable_random_interleaving=true",
        "--benchmark_filter=all"};
    std::array<char*, words.size() + 1> argv{};
    for (std::size_t i = 0; i < words.size(); ++i) argv[i] = words[i].data();
    int argc = static_cast<int>(words.size());
    benchmark::Initialize(&argc, argv.data());
    return true;
  }();
  (void)initialized;
}

void CheckAnswer(const Case& c) {
  if (!c.check) return;
  const std::string wrong = c.check();
  if (!wrong.empty()) throw WrongAnswer(c.name + ": " + wrong);
}

}  // namespace

double SecondsOf(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

double Timing::Quantile(double quantile) const {
  return QuantileOf(samples, quantile);
}

std::vector<double> RatiosOf(const Timing& numerator,
                             const Timing& denominator) {
  std::vector<double> ratios = numerator.samples;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    ratios[i] /= denominator.samples[i];
  }
  return ratios;
}

Ratio RatioOf(const Timing& numerator, const Timing& denominator) {
  return SpreadOf({RatiosOf(numerator, denominator)});
}

Ratio SpreadOf(const Timing& timing) {
  return {timing.Median(), timing.Quantile(0.25), timing.Quantile(0.75)};
}

Ratio RangeOf(const std::vector<double>& values) {
  return {QuantileOf(values, 0.5), QuantileOf(values, 0.0),
          QuantileOf(values, 1.0)};
}

void KeepResult(std::uint32_t result) { benchmark::DoNotOptimize(result); }

namespace {

std::vector<Timing> MeasureOnce(const std::vector<Case>& cases,
                                const Effort& effort) {
  std::vector<Timing> timings(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    CheckAnswer(c);
    benchmark::RegisterBenchmark(std::to_string(i).c_str(),
                                 [&c](benchmark::State& state) {
                                   for (auto _ : state) c.run();
                                   if (c.after) c.after();
                                 })
        ->Iterations(static_cast<benchmark::IterationCount>(
            CallsPerRepetition(c, effort)))
        ->Repetitions(static_cast<int>(effort.repetitions));
    if (i + 1 == cases.size() || cases[i + 1].group != c.group) {
      Collector collector(cases, timings);
      benchmark::RunSpecifiedBenchmarks(&collector);
      benchmark::ClearRegisteredBenchmarks();
    }
  }
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (timings[i].samples.size() != effort.repetitions) {
      throw std::logic_error(cases[i].name + ": was not timed");
    }
  }
  return timings;
}

}  // namespace

std::vector<Timing> Measure(const std::vector<Case>& cases,
                            const Effort& effort) {
  InitializeOnce();
  // A browser compiles a hot function again, 10 times as fast, between the
  // choice of the iterations and the timing.
  constexpr int kTries = 3;
  for (int i = 1;; ++i) {
    std::vector<Timing> timings = MeasureOnce(cases, effort);
    // Ratios of a time of 0 are no numbers.
    const auto without_time = std::find_if(
        timings.begin(), timings.end(),
        [](const Timing& timing) { return !(timing.Quantile(0.0) > 0.0); });
    if (without_time == timings.end()) return timings;
    if (i == kTries) {
      const auto index =
          static_cast<std::size_t>(without_time - timings.begin());
      throw std::runtime_error(cases[index].name +
                               ": took no time, so the clock is too coarse");
    }
  }
}

}  // namespace halfspace::bench
