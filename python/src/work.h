// The threads of one call, and its contact with the interpreter: Ctrl-C and
// progress.
#ifndef HALFSPACE_PYTHON_WORK_H_
#define HALFSPACE_PYTHON_WORK_H_

#include <halfspace/c/halfspace.h>
#include <pybind11/pybind11.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>

namespace halfspace::python {

// Runs the parts of a call on several threads, of which the calling thread is
// one. Call it without the interpreter's lock. Between two parts, the calling
// thread takes the lock up to 20 times a second: it runs the handlers of
// signals, and calls progress(done, total). What these raise ends the call.
class Work {
 public:
  // `progress` is a callable or None.
  Work(std::size_t threads, pybind11::object progress)
      : threads_(threads), progress_(std::move(progress)) {}

  // During the next Run(), progress() receives numbers from `begin` to `end`,
  // and `total`.
  void SetStage(std::size_t begin, std::size_t end, std::size_t total) {
    begin_ = begin;
    end_ = end;
    total_ = total;
  }

  // During the next Run(), progress() receives `total` twice. For parts that
  // only copy results.
  void SetLastStage() { begin_ = end_ = total_; }

  // Calls part(i, thread) for each i below `count`, where thread is below
  // threads(). Returns when all calls have returned. Throws the error of the
  // lowest part that failed, which is the same for any number of threads.
  void Run(std::size_t count,
           const std::function<void(std::size_t, std::size_t)>& part);

  // Calls progress(total, total), unless there was nothing to do. Can be called
  // with the interpreter's lock and without it.
  void Finish();

  std::size_t threads() const { return threads_; }

 private:
  // Throws what a signal handler or progress() raised.
  void Contact(std::size_t done, std::size_t count);

  std::size_t threads_;
  pybind11::object progress_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t total_ = 0;
  std::chrono::steady_clock::time_point last_contact_ =
      std::chrono::steady_clock::now();
};

// The tuple that how() of _arrays.py returns: the mask, the threads and the
// progress.
inline std::uint32_t MaskOf(const pybind11::tuple& how) {
  return how[0].cast<std::uint32_t>();
}
inline Work WorkOf(const pybind11::tuple& how) {
  return {how[1].cast<std::size_t>(), how[2]};
}

// Runs the parts of a C function that takes a hs_run_function and calls it
// about `passes` times. The progress goes from 0 to `end` of `total`.
struct Threads {
  // The hs_run_function, whose context is a Threads.
  static void Run(void* threads, std::size_t count, hs_part_function part,
                  void* of_part);

  // Throws what ended Run(), or else the message of the C function.
  void Check(hs_status status) const;

  Work& work;
  std::size_t passes;
  std::size_t end;
  std::size_t total;
  std::size_t pass = 0;
  std::exception_ptr error = nullptr;
};

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_WORK_H_
