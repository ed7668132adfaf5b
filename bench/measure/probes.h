// What disturbed a run: a clock that changes its speed, and other programs.
#ifndef HALFSPACE_BENCH_MEASURE_PROBES_H_
#define HALFSPACE_BENCH_MEASURE_PROBES_H_

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "bench/measure/measure.h"
#include "bench/measure/team.h"

#if defined(__unix__) || defined(__APPLE__)
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace halfspace::bench {

struct Load {
  double cpu_share = 1.0;      // of the time in which this thread had a CPU
  double interruptions = 0.0;  // of this program by another one, per second
  // CPUs that other programs, and other machines on the same hardware, took.
  // Empty if the system does not say.
  std::optional<double> others = {};
};

// Whether other programs changed the times. Less than this changed no ratio of
// a kernel to itself by more than a twentieth.
inline bool IsLoaded(const Load& load, int cpus) {
  constexpr double kLeastShare = 0.95;
  constexpr double kMostInterruptions = 30.0;
  constexpr double kMostOfOthers = 0.1;  // of all CPUs
  return load.cpu_share < kLeastShare ||
         load.interruptions > kMostInterruptions ||
         load.others.value_or(0.0) > kMostOfOthers * std::max(cpus, 1);
}

class LoadProbe {
 public:
  LoadProbe() : begin_(Now()) {}

  // Since this object was made, by the thread that made it.
  Load Sample() const {
    const State now = Now();
    const double seconds = std::max(
        1e-3, std::chrono::duration<double>(now.time - begin_.time).count());
    Load load;
    if (now.thread > 0.0) {
      load.cpu_share = std::min(1.0, (now.thread - begin_.thread) / seconds);
    }
    load.interruptions = (now.interruptions - begin_.interruptions) / seconds;
    if (begin_.all && now.all) {
      load.others = std::max(0.0, (*now.all - *begin_.all) / seconds -
                                      (now.own - begin_.own) / seconds);
    }
    return load;
  }

 private:
  struct State {
    std::chrono::steady_clock::time_point time =
        std::chrono::steady_clock::now();
    double thread = ThreadSeconds();
    double own = 0.0;  // CPU seconds of this program
    double interruptions = 0.0;
    std::optional<double> all = {};  // CPU seconds of all programs
  };

  static State Now() {
    State state;
#if defined(__unix__) || defined(__APPLE__)
    rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) == 0) {
      const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) +
               1e-6 * static_cast<double>(time.tv_usec);
      };
      state.own = seconds(usage.ru_utime) + seconds(usage.ru_stime);
      state.interruptions = static_cast<double>(usage.ru_nivcsw);
    }
    // user, nice, system, idle, iowait, irq, softirq, steal
    std::ifstream file("/proc/stat");
    std::string name;
    double ticks[8] = {};
    file >> name;
    for (double& each : ticks) file >> each;
    if (file && name == "cpu" && ticks[3] > 0.0) {
      state.all =
          (ticks[0] + ticks[1] + ticks[2] + ticks[5] + ticks[6] + ticks[7]) /
          static_cast<double>(sysconf(_SC_CLK_TCK));
    }
#endif
    return state;
  }

  State begin_;
};

// How fast the clock of this CPU is, now and then during a run.
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

#endif  // HALFSPACE_BENCH_MEASURE_PROBES_H_
