// One other thread that is kept alive, so that starting it costs nothing.
#ifndef HALFSPACE_BENCH_TWO_THREADS_H_
#define HALFSPACE_BENCH_TWO_THREADS_H_

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

namespace halfspace::bench {

class OtherThread {
 public:
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

  // Until it is done.
  void Wait() const {
    while (done_ != started_) {
    }
  }

 private:
  // Awake all the time: to be woken takes as long as a tenth of the work, and
  // who yields on a busy machine is not back for longer.
  void Serve() {
    for (unsigned next = 1;; ++next) {
      while (started_ < next) {
      }
      if (is_over_) return;
      work_();
      done_ = next;
    }
  }

  std::function<void()> work_;
  std::atomic<bool> is_over_{false};
  std::atomic<unsigned> started_{0};
  std::atomic<unsigned> done_{0};
  std::thread thread_;  // last: it uses the others
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_TWO_THREADS_H_
