// Who may read the tree of a broad phase and who may change it.
//
// Each thread counts its queries on its own cache line, so queries write no
// line of another thread. One thread at a time has the right to change. It
// closes the lock, waits until all lines are 0, and then has exclusive access.
// A query that finds the lock closed leaves and waits until it is open. A query
// has left when it calls a function of the caller's, so the queries that a
// change waits for wait for nobody, and there is no deadlock.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_LOCK_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_LOCK_H_

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>

namespace halfspace::detail {

class ReadersLock {
 public:
  ReadersLock() = default;
  ReadersLock(const ReadersLock&) = delete;
  ReadersLock& operator=(const ReadersLock&) = delete;

  // The line of this thread: its own, or, if all are taken, the line that all
  // other threads share.
  static std::size_t LineOfThread() {
    return line_of_thread_ != 0 ? line_of_thread_ - 1 : NewLine();
  }
  void Enter(std::size_t line) {
    if (line >= used_.load(std::memory_order_seq_cst)) Use(line);
    CountIn(line);
    if (is_closed_.load(std::memory_order_seq_cst)) [[unlikely]] {
      EnterSlowly(line);
    }
  }
  void Leave(std::size_t line) {
    std::atomic<std::uint32_t>& readers = lines_[line].readers;
    if (line < kOwnLines) {
      readers.store(readers.load(std::memory_order_relaxed) - 1,
                    std::memory_order_release);
    } else {
      readers.fetch_sub(1, std::memory_order_release);
    }
  }

  // Takes and gives back the right to change.
  void Lock() { changes_.lock(); }
  void Unlock() { changes_.unlock(); }
  // Close() waits for exclusive access, and Open() ends it. Both need the right
  // to change.
  void Close();
  void Open() { is_closed_.store(false, std::memory_order_release); }
  // Calls Lock() and Close(), if neither has to wait, and returns whether.
  bool TryLockAndClose();

  // Whether a query and a change have waited for each other since the last
  // TakeWaits(), which needs the right to change.
  bool HasWaits() const { return has_waits_.load(std::memory_order_relaxed); }
  bool TakeWaits() {
    // Not by exchange(), which is a call of libatomic on riscv64 (gcc 12). A
    // wait that is lost is one of many.
    const bool has_waits = HasWaits();
    has_waits_.store(false, std::memory_order_relaxed);
    return has_waits;
  }

 private:
  static constexpr std::size_t kOwnLines = 64;
  struct alignas(64) Line {
    std::atomic<std::uint32_t> readers{0};
  };

  static std::size_t NewLine();
  void Use(std::size_t line);
  void CountIn(std::size_t line) {
    std::atomic<std::uint32_t>& readers = lines_[line].readers;
    if (line < kOwnLines) {
      readers.exchange(readers.load(std::memory_order_relaxed) + 1,
                       std::memory_order_seq_cst);
    } else {
      readers.fetch_add(1, std::memory_order_seq_cst);
    }
  }
  void EnterSlowly(std::size_t line);
  // The lock must be closed.
  bool HasReaders() const;

  // 1 more than the number of the line, or 0 in a new thread.
  static constinit inline thread_local std::size_t line_of_thread_ = 0;

  std::atomic<bool> is_closed_{false};
  std::atomic<bool> has_waits_{false};
  std::atomic<std::size_t> used_{0};  // lines
  alignas(64) std::mutex changes_;
  Line lines_[kOwnLines + 1];
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_LOCK_H_
