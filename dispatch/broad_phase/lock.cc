#include "dispatch/broad_phase/lock.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "hwy/cache_control.h"

namespace halfspace::detail {
namespace {

// Waits a little. Most flushes take less than a microsecond, so the first waits
// keep the processor.
class Pause {
 public:
  void operator()() {
    ++count_;
    if (count_ < kSpins) {
      hwy::Pause();
    } else if (count_ < kTurns) {
      std::this_thread::yield();
    } else {
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
  }

 private:
  static constexpr std::size_t kSpins = 100;
  static constexpr std::size_t kTurns = 1000;
  std::size_t count_ = 0;
};

}  // namespace

std::size_t ReadersLock::NewLine() {
  static constinit std::atomic<std::size_t> threads{0};
  const std::size_t thread = threads.fetch_add(1, std::memory_order_relaxed);
  line_of_thread_ = std::min(thread, kOwnLines) + 1;
  return line_of_thread_ - 1;
}

void ReadersLock::Use(std::size_t line) {
  std::size_t used = used_.load(std::memory_order_relaxed);
  while (used <= line && !used_.compare_exchange_weak(
                             used, line + 1, std::memory_order_seq_cst)) {
  }
}

void ReadersLock::EnterSlowly(std::size_t line) {
  // All queries read its cache line.
  if (!HasWaits()) has_waits_.store(true, std::memory_order_relaxed);
  do {
    Leave(line);
    for (Pause pause; is_closed_.load(std::memory_order_acquire);) pause();
    CountIn(line);
  } while (is_closed_.load(std::memory_order_seq_cst));
}

bool ReadersLock::HasReaders() const {
  const std::size_t used = used_.load(std::memory_order_seq_cst);
  std::uint32_t readers = 0;
  for (std::size_t line = 0; line < used; ++line) {
    readers |= lines_[line].readers.load(std::memory_order_seq_cst);
  }
  return readers != 0;
}

void ReadersLock::Close() {
  is_closed_.store(true, std::memory_order_seq_cst);
  if (!HasReaders()) return;
  has_waits_.store(true, std::memory_order_relaxed);
  for (Pause pause; HasReaders();) pause();
}

bool ReadersLock::TryLockAndClose() {
  if (!changes_.try_lock()) return false;
  is_closed_.store(true, std::memory_order_seq_cst);
  if (!HasReaders()) return true;
  Open();
  Unlock();
  return false;
}

}  // namespace halfspace::detail
