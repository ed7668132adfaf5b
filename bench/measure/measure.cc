#include "bench/measure/measure.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>

#include "bench/measure/team.h"

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

// Fixed in advance, so that the time of the whole run can be estimated. The
// second call is the warm one; it cannot change the answer for a long one.
std::size_t IterationsFor(const Case& c, const Effort& effort) {
  const double seconds = effort.seconds_per_repetition;
  std::size_t least = 1;
  if (effort.is_complete) {
    least = (c.runs_of_all + effort.repetitions - 1) / effort.repetitions;
  }
  if (SecondsOf(c.run) > 4.0 * seconds) return least;
  const double once = std::max(SecondsOf(c.run), 1e-9);
  return std::max(least, static_cast<std::size_t>(
                             std::clamp(std::ceil(seconds / once), 1.0, 1e9)));
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

Ratio RatioOf(const std::vector<double>& numerator,
              const std::vector<double>& denominator) {
  std::vector<double> ratios;
  const std::size_t count = std::min(numerator.size(), denominator.size());
  for (std::size_t i = 0; i < count; ++i) {
    ratios.push_back(numerator[i] / denominator[i]);
  }
  return {QuantileOf(ratios, 0.5), QuantileOf(ratios, 0.25),
          QuantileOf(ratios, 0.75)};
}

Ratio RatioOf(const Timing& numerator, const Timing& denominator) {
  return RatioOf(numerator.samples, denominator.samples);
}

Ratio SpreadOf(const Timing& timing) {
  return {timing.Median(), timing.Quantile(0.25), timing.Quantile(0.75)};
}

Ratio RangeOf(const std::vector<double>& values) {
  return {QuantileOf(values, 0.5), QuantileOf(values, 0.0),
          QuantileOf(values, 1.0)};
}

void KeepResult(std::uint32_t result) {
#if defined(__GNUC__)
  asm volatile("" : : "r"(result) : "memory");
#else
  static volatile std::uint32_t kept;
  kept = result;
#endif
}

std::vector<Timing> Measure(const std::vector<Case>& cases,
                            const Effort& effort, Progress& progress) {
  static std::mt19937 random;
  std::vector<Timing> timings(cases.size());
  // Checking and calibrating a case takes about as long as one repetition.
  const double steps =
      static_cast<double>(cases.size() * (effort.repetitions + 1));
  double steps_done = 0.0;
  const auto step = [&] { progress.Update(++steps_done / steps); };
  std::vector<std::size_t> order;  // of the repetitions of a group
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    timings[i].name = c.name;
    timings[i].items = c.items;
    CheckAnswer(c);
    timings[i].iterations = IterationsFor(c, effort);
    order.insert(order.end(), effort.repetitions, i);
    step();
    if (i + 1 < cases.size() && cases[i + 1].group == c.group) continue;
    std::shuffle(order.begin(), order.end(), random);
    for (std::size_t each : order) {
      Timing& timing = timings[each];
      // CPU time of this thread: a kernel never waits, and real time would
      // count the other programs of a busy machine.
      const double start = ThreadSeconds();
      for (std::size_t n = 0; n < timing.iterations; ++n) cases[each].run();
      const double ns = 1e9 * (ThreadSeconds() - start) /
                        (static_cast<double>(timing.iterations) * timing.items);
      // Ratios of such times are no numbers.
      if (!(ns > 0.0)) {
        throw std::runtime_error(timing.name +
                                 ": took no time, so the clock is too coarse");
      }
      timing.samples.push_back(ns);
      step();
    }
    order.clear();
  }
  return timings;
}

}  // namespace halfspace::bench
