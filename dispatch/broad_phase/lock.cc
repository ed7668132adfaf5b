#include "dispatch/broad_phase/lock.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "hwy/cache_control.h"

namespace halfspace::detail {
namespace {

// How long a new query waits for a waiting change. This is longer than almost
// every query, so changes do not starve.
constexpr std::chrono::microseconds kPatience(50);

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

void ReadersLock::EnterSlowly(std::size_t line, bool is_inside) {
  const auto begin = std::chrono::steady_clock::now();
  const auto is_over = [begin] {
    return std::chrono::steady_clock::now() - begin > kPatience;
  };
  Pause pause;
  for (;;) {
    const std::uint32_t state = state_.load(std::memory_order_seq_cst);
    if (state == kOpen) return;
    if (state == kChangeWaits && (is_inside || is_over())) return;
    Leave(line);
    const auto has_to_wait = [&] {
      const std::uint32_t now = state_.load(std::memory_order_acquire);
      return now == kIsChanged ||
             (now == kChangeWaits && !is_inside && !is_over());
    };
    do {
      pause();
    } while (has_to_wait());
    CountIn(line);
  }
}

bool ReadersLock::Close() {
  state_.store(kIsChanged, std::memory_order_seq_cst);
  const std::size_t used = used_.load(std::memory_order_seq_cst);
  std::uint32_t readers = 0;
  for (std::size_t line = 0; line < used; ++line) {
    readers |= lines_[line].readers.load(std::memory_order_seq_cst);
  }
  return readers == 0;
}

void ReadersLock::Lock() {
  changes_.lock();
  for (Pause pause; !Close(); pause()) {
    state_.store(kChangeWaits, std::memory_order_seq_cst);
  }
}

bool ReadersLock::TryLock() {
  if (!changes_.try_lock()) return false;
  if (Close()) return true;
  Unlock();
  return false;
}

void ReadersLock::Unlock() {
  state_.store(kOpen, std::memory_order_release);
  changes_.unlock();
}

}  // namespace halfspace::detail
