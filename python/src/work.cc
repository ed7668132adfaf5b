#include "work.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "columns.h"

namespace py = pybind11;

namespace halfspace::python {

void Work::Run(std::size_t count,
               const std::function<void(std::size_t, std::size_t)>& part) {
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::mutex mutex;
  std::exception_ptr error;
  std::size_t failed = count;
  const auto work = [&](std::size_t thread) {
    std::size_t i = 0;
    try {
      for (i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
        part(i, thread);
        const std::size_t so_far = done.fetch_add(1) + 1;
        if (thread == 0) Contact(so_far, count);
      }
    } catch (...) {
      next.store(count);
      const std::scoped_lock lock(mutex);
      if (i < failed) error = std::current_exception();
      failed = std::min(failed, i);
    }
  };
  std::vector<std::thread> others;
  const std::size_t used = std::min(threads_, count);
  others.reserve(used);
  try {
    for (std::size_t t = 1; t < used; ++t) others.emplace_back(work, t);
  } catch (const std::exception&) {
    // The system has no more threads. Those that there are do the work.
  }
  work(0);
  for (std::thread& other : others) other.join();
  if (error != nullptr) std::rethrow_exception(error);
}

void Work::Finish() {
  py::gil_scoped_acquire lock;
  // Callers divide by the total.
  if (!progress_.is_none() && total_ != 0) progress_(total_, total_);
}

void Work::Contact(std::size_t done, std::size_t count) {
  constexpr auto kInterval = std::chrono::milliseconds(50);
  const auto now = std::chrono::steady_clock::now();
  if (now - last_contact_ < kInterval) return;
  last_contact_ = now;
  py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (progress_.is_none()) return;
  const double share = static_cast<double>(done) / static_cast<double>(count);
  progress_(begin_ + static_cast<std::size_t>(
                         share * static_cast<double>(end_ - begin_)),
            total_);
}

void Threads::Run(void* threads, std::size_t count, hs_part_function part,
                  void* of_part) {
  auto& its = *static_cast<Threads*>(threads);
  // The library does not document the number of passes. If there are more than
  // expected, the progress waits near the end.
  const std::size_t first = std::min(its.pass, its.passes - 1);
  ++its.pass;
  its.work.SetStage(its.end * first / its.passes,
                    its.end * (first + 1) / its.passes, its.total);
  try {
    its.work.Run(count, [&](std::size_t i, std::size_t) { part(of_part, i); });
  } catch (...) {
    // The C function would keep the text alone. Any exception ends it.
    its.error = std::current_exception();
    throw std::exception();
  }
}

void Threads::Check(hs_status status) const {
  if (error != nullptr) std::rethrow_exception(error);
  python::Check(status);
}

}  // namespace halfspace::python
