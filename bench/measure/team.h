// Threads that work at the same time, and how much of a CPU each has had.
#ifndef HALFSPACE_BENCH_MEASURE_TEAM_H_
#define HALFSPACE_BENCH_MEASURE_TEAM_H_

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace halfspace::bench {

// A thread that had less of a CPU shared it with other programs.
inline constexpr double kWholeCpu = 0.9;

struct TeamTime {
  double seconds = 0.0;    // from the first start to the last end
  double cpu_share = 1.0;  // of the thread that was on a CPU least of its time
};

// CPU seconds of this thread, and 0 on systems that have no such clock. Windows
// counts them in steps of 16 ms, so there it is real time.
inline double ThreadSeconds() {
#if defined(_WIN32)
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
#elif defined(CLOCK_THREAD_CPUTIME_ID)
  timespec time;
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) == 0) {
    return static_cast<double>(time.tv_sec) +
           1e-9 * static_cast<double>(time.tv_nsec);
  }
#endif
  return 0.0;
}

// work(i) in each of `threads` threads, of which the caller is thread 0. It
// must take so long that a thread which starts later does not count. Throws
// std::system_error if no thread can be started, and what work() has thrown.
inline TeamTime RunTeam(std::size_t threads,
                        const std::function<void(std::size_t)>& work) {
  using Clock = std::chrono::steady_clock;
  struct Result {
    Clock::time_point start;
    Clock::time_point end;
    double cpu = 0.0;
    std::exception_ptr error;
  };
  std::vector<Result> results(threads);
  const auto run = [&](std::size_t i) {
    Result& result = results[i];
    const double cpu = ThreadSeconds();
    result.start = Clock::now();
    try {
      work(i);
    } catch (...) {
      result.error = std::current_exception();
    }
    result.end = Clock::now();
    result.cpu = ThreadSeconds() - cpu;
  };
  {
    // Not std::async, which Debian's libstdc++ for armel lacks.
    struct Others {
      std::vector<std::thread> threads;
      ~Others() {
        for (std::thread& thread : threads) thread.join();
      }
    } others;
    for (std::size_t i = 1; i < threads; ++i) {
      others.threads.emplace_back(run, i);
    }
    run(0);
  }
  for (const Result& result : results) {
    if (result.error) std::rethrow_exception(result.error);
  }
  TeamTime time;
  Clock::time_point start = results[0].start;
  Clock::time_point end = results[0].end;
  for (const Result& result : results) {
    start = std::min(start, result.start);
    end = std::max(end, result.end);
    const double real =
        std::chrono::duration<double>(result.end - result.start).count();
    if (real > 0.0 && result.cpu > 0.0) {
      time.cpu_share = std::min(time.cpu_share, result.cpu / real);
    }
  }
  time.seconds = std::chrono::duration<double>(end - start).count();
  return time;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_TEAM_H_
