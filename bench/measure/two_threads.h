// A second thread that waits between runs, so that starting it is not timed.
#ifndef HALFSPACE_BENCH_MEASURE_TWO_THREADS_H_
#define HALFSPACE_BENCH_MEASURE_TWO_THREADS_H_

#include <atomic>
#include <exception>
#include <functional>
#include <thread>
#include <utility>

namespace halfspace::bench {

class OtherThread {
 public:
  // Throws std::system_error where no thread can be started.
  explicit OtherThread(std::function<void()> work)
      : work_(std::move(work)), thread_([this] { Serve(); }) {}

  ~OtherThread() {
    is_over_ = true;
    ++started_;
    thread_.join();
  }
  OtherThread(const OtherThread&) = delete;
  OtherThread& operator=(const OtherThread&) = delete;

  // Does the work once over there.
  void Start() { ++started_; }

  // Until it is done. Throws what the work has thrown.
  void Wait() const {
    while (done_ != started_) {
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  // Awake all the time: to be woken takes as long as a tenth of the work, and
  // who yields on a busy machine is not back for longer.
  void Serve() {
    for (unsigned next = 1;; ++next) {
      while (started_ < next) {
      }
      if (is_over_) return;
      try {
        work_();
      } catch (...) {
        error_ = std::current_exception();
      }
      done_ = next;
    }
  }

  std::function<void()> work_;
  std::exception_ptr error_;  // handed over by done_
  std::atomic<bool> is_over_{false};
  std::atomic<unsigned> started_{0};
  std::atomic<unsigned> done_{0};
  std::thread thread_;  // last: it uses the others
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_TWO_THREADS_H_
