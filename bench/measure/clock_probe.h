// How fast this CPU's clock is, now and then during a run.
#ifndef HALFSPACE_BENCH_MEASURE_CLOCK_PROBE_H_
#define HALFSPACE_BENCH_MEASURE_CLOCK_PROBE_H_

#include <algorithm>
#include <cstdint>

#include "bench/measure/measure.h"

namespace halfspace::bench {

class ClockProbe {
 public:
  // Busy until an idle CPU's clock has risen.
  ClockProbe() {
    constexpr double kSeconds = 0.05;
    for (double passed = 0.0; passed < kSeconds;) {
      passed += SecondsOf([] { KeepResult(Chain()); });
    }
  }

  // The fastest of some chains of multiplications, each of which waits for the
  // one before: nothing but the clock changes how long that takes, where the
  // chain is so short that no other program interrupts it.
  void Sample() {
    constexpr int kTries = 20;
    double fastest = 1e9;
    for (int i = 0; i < kTries; ++i) {
      fastest = std::min(fastest, SecondsOf([] { KeepResult(Chain()); }));
    }
    slowest_ = std::max(slowest_, fastest);
    fastest_ = std::min(fastest_, fastest);
  }

  // How much slower the slowest sample is than the fastest: 0 if none is.
  double Drift() const {
    return slowest_ == 0.0 ? 0.0 : slowest_ / fastest_ - 1.0;
  }

 private:
  static std::uint32_t Chain() {
    std::uint32_t x = 1;
    for (int i = 0; i < 20'000; ++i) {
      x = x * 1664525u + 1013904223u;
      KeepResult(x);
    }
    return x;
  }

  double slowest_ = 0.0;
  double fastest_ = 1e9;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_CLOCK_PROBE_H_
