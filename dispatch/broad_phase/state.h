// What a broad phase owns: a record of each body, and versions of the tree.
//
// Readers (queries and moves) hold a version by a counter in it. A writer, who
// has the mutex, builds the next version beside the current one, announces it
// as `upcoming`, and then makes it the current one. It reuses a version when
// its counters are 0. The counters are never freed, so a reader may count
// itself into a version that was just replaced, sees that, and tries again.
//
// No body is lost between two versions:
// - A mover writes the body's record, then its mark kMoved, then counts itself
//   into the current version C, then loads `upcoming` and the current version
//   again, and widens the body in each of these.
// - A writer stores `upcoming` = N, then reads all counters of C, then widens
//   each body in N that has a mark, then makes N the current version.
// Stores and loads of the two pointers and of the counters are sequentially
// consistent. If the mover did not see N, it counted itself before the writer
// read the counter. The counters are changed only by read-modify-write, so the
// writer's read synchronizes with the mover's, and the writer sees the mark.
//
// In a version that readers can see, the floats of the tree change only by
// atomic stores, and only outward: minima become less, maxima greater. Nothing
// else changes. So a walk sees for each body the bound that enclosed it when
// the walk began, or a larger one. The kernels read the floats by vector loads
// that are not atomic. On the supported machines no aligned 32-bit lane of a
// vector load is torn, and a lane is the old or the new value. The copy of a
// tree relies on the same. The thread sanitizer cannot know this: see
// WithRacyReads.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <utility>

#include "dispatch/broad_phase/list.h"
#include "dispatch/bvh/scratch.h"
#include "halfspace/broad_phase.h"
#include "kernels/prefetch.h"

#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define HALFSPACE_THREAD_SANITIZER 1
#endif
#elif defined(__SANITIZE_THREAD__)
#define HALFSPACE_THREAD_SANITIZER 1
#endif
#ifdef HALFSPACE_THREAD_SANITIZER
extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
}
#endif

namespace halfspace::detail {

// The thread sanitizer ignores plain reads of this thread for the life of an
// object of this class: reads of a tree that movers may widen.
class WithRacyReads {
 public:
  WithRacyReads() { Begin(); }
  ~WithRacyReads() { End(); }
  WithRacyReads(const WithRacyReads&) = delete;
  WithRacyReads& operator=(const WithRacyReads&) = delete;

 private:
  friend class WithoutRacyReads;
#ifdef HALFSPACE_THREAD_SANITIZER
  static void Begin() { AnnotateIgnoreReadsBegin(__FILE__, __LINE__); }
  static void End() { AnnotateIgnoreReadsEnd(__FILE__, __LINE__); }
#else
  static void Begin() {}
  static void End() {}
#endif
};

// The opposite, for the caller's functions inside a walk.
class WithoutRacyReads {
 public:
  WithoutRacyReads() { WithRacyReads::End(); }
  ~WithoutRacyReads() { WithRacyReads::Begin(); }
  WithoutRacyReads(const WithoutRacyReads&) = delete;
  WithoutRacyReads& operator=(const WithoutRacyReads&) = delete;
};

static_assert(std::atomic_ref<float>::required_alignment == alignof(float) &&
                  std::atomic_ref<float>::is_always_lock_free &&
                  std::atomic<std::uint32_t>::is_always_lock_free,
              "a plane of a tree is changed by itself");

inline constexpr std::size_t kMostBodyPlanes = 8;  // AaboBroadPhase3

struct Body {
  float planes[kMostBodyPlanes];
  BodyMasks masks;
};

// A record of each id: its exact bound and its masks, which are read and
// written together, and marks of what changed. A record has one writer at a
// time.
class Bodies {
 public:
  enum Mark : std::uint8_t {
    kMoved = 1,     // since the tree was tightened
    kNewPairs = 2,  // since the last UpdatePairs()
    kListed = 4,    // in the list of a call, while the call checks it
    kReplaced = 8,  // was erased since the tree was tightened
  };

  Bodies(const MemoryResource& memory, std::size_t ids, std::size_t planes);

  std::size_t bytes() const;

  bool Has(std::size_t id) const {
    return (At(id)[0].load(std::memory_order_acquire) & kPresent) != 0;
  }
  // A record is in one line or in two.
  void Prefetch(std::size_t id) const {
    kernels::Prefetch(At(id));
    kernels::Prefetch(At(id) + words_of_body_ - 1);
  }
  // Returns whether the body exists, and all of its record as it was at one
  // time.
  bool Read(std::size_t id, Body& body) const;

  void Write(std::size_t id, const float* planes, const BodyMasks* masks,
             bool is_present);

  // Returns whether the body had one of the marks.
  bool AddMark(std::size_t id, std::uint8_t marks) {
    return (marks_[id].fetch_or(marks) & marks) != 0;
  }
  void TakeMark(std::size_t id, Mark mark) {
    marks_[id].fetch_and(static_cast<std::uint8_t>(~mark));
  }
  // Faster. A mark that another thread takes away at the same time may stay.
  void SetMarks(std::size_t id, std::uint8_t marks) {
    marks_[id].store(marks, std::memory_order_release);
  }
  std::uint8_t MarksOf(std::size_t id) const {
    return marks_[id].load(std::memory_order_acquire);
  }

 private:
  // The first word of a record counts its writes, above two bits.
  static constexpr std::uint32_t kIsWritten = 1;
  static constexpr std::uint32_t kPresent = 2;
  static constexpr std::uint32_t kOneWrite = 4;

  std::atomic<std::uint32_t>* At(std::size_t id) const {
    return words_ + id * words_of_body_;
  }

  std::size_t ids_;
  std::size_t planes_;
  std::size_t words_of_body_;
  Scratch memory_;
  std::atomic<std::uint32_t>* words_;
  std::atomic<std::uint8_t>* marks_;
};

// A tree, and the bodies that are not in it yet.
class Version {
 public:
  // Bodies that wait for the next tree. Each query tests them.
  static constexpr std::size_t kMostPending = 256;

  explicit Version(BvhTree empty) : tree(std::move(empty)) {}

  // A reader counts itself in and out of a counter of its thread's.
  void Enter(std::size_t counter) {
    counters_[counter].readers.fetch_add(1, std::memory_order_seq_cst);
  }
  void Leave(std::size_t counter) {
    counters_[counter].readers.fetch_sub(1, std::memory_order_seq_cst);
  }
  // Reads all counters.
  bool HasReaders() const;
  static std::size_t CounterOfThread();

  std::size_t PendingCount() const {
    return pending_count_.load(std::memory_order_acquire);
  }
  std::uint32_t Pending(std::size_t i) const {
    return pending_[i].load(std::memory_order_relaxed);
  }
  bool IsPending(std::uint32_t id) const;
  void AddPending(std::uint32_t id);
  void ClearPending() { pending_count_.store(0, std::memory_order_release); }

  // Makes the body's bound in the tree, if it has one, enclose `planes`. While
  // readers walk. `is_all` also looks at the nodes if the bound encloses it.
  void Widen(std::uint32_t id, const float* planes, bool is_all);
  // Whether the body's bound and its nodes do.
  bool Encloses(std::uint32_t id, const float* planes) const;

  BvhTree tree;
  Version* next = nullptr;  // in the list of all

 private:
  static constexpr std::size_t kCounters = 16;
  struct alignas(64) Counter {
    std::atomic<std::uint32_t> readers{0};
  };

  std::atomic<std::uint32_t> pending_count_{0};
  std::atomic<std::uint32_t> pending_[kMostPending];
  Counter counters_[kCounters];
};

class BroadPhaseState {
 public:
  BroadPhaseState(const BvhShape& tree_shape, std::size_t ids,
                  const BroadPhaseOptions& with);
  BroadPhaseState(const BroadPhaseState&) = delete;
  BroadPhaseState& operator=(const BroadPhaseState&) = delete;
  ~BroadPhaseState();

  std::size_t planes() const { return shape.has_max ? 2u * shape.axes : 0u; }

  void CheckIds(const char* call, Span<const std::uint32_t> ids) const;
  // Throws, in the name of `call`, unless the list is one of ids and `others`
  // has an element for each. Reads no id.
  void CheckList(const char* call, Span<const std::uint32_t> ids,
                 const char* name, const void* others, std::size_t other_count,
                 std::size_t alignment) const;
  // The first that is not the id of a body, or ids.size().
  std::size_t FindAbsent(Span<const std::uint32_t> ids) const;
  [[noreturn]] void ThrowAbsent(const char* call, Span<const std::uint32_t> ids,
                                std::size_t i) const;
  // An id that cannot be inserted.
  [[noreturn]] void ThrowTaken(const char* call, Span<const std::uint32_t> ids,
                               std::size_t i) const;
  void CheckBodies(const char* call, Span<const std::uint32_t> ids) const;

  const BvhShape shape;
  const std::size_t max_ids;
  const BroadPhaseOptions options;
  Bodies bodies;
  std::atomic<std::size_t> size{0};
  std::atomic<Version*> current;
  std::atomic<Version*> upcoming{nullptr};

  // The rest belongs to who has the mutex.
  std::mutex mutex;
  Version* versions = nullptr;
  std::size_t id_limit = 0;   // above all ids that were ever in use
  List<std::uint64_t> pairs;  // a in the upper half, ascending

  Version* NewVersion();
};

void CheckMargin(const char* call, const char* name, float margin);

// The current version, for the life of an object of this class.
class Held {
 public:
  explicit Held(const BroadPhaseState& state)
      : Held(state.current, Version::CounterOfThread()) {}
  // The version that `from` points to, or none.
  Held(const std::atomic<Version*>& from, std::size_t counter)
      : counter_(counter) {
    for (;;) {
      version_ = from.load(std::memory_order_seq_cst);
      if (version_ == nullptr) return;
      version_->Enter(counter_);
      if (from.load(std::memory_order_seq_cst) == version_) return;
      version_->Leave(counter_);
    }
  }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;
  ~Held() {
    if (version_ != nullptr) version_->Leave(counter_);
  }

  Version* get() const { return version_; }
  Version& operator*() const { return *version_; }
  Version* operator->() const { return version_; }

 private:
  std::size_t counter_;
  Version* version_;
};

// Calls visit(id) for the ids below the limit that have a mark.
template <typename Visit>
void ForEachMarked(const BroadPhaseState& state, Bodies::Mark mark,
                   const Visit& visit) {
  for (std::size_t id = 0; id < state.id_limit; ++id) {
    if ((state.bodies.MarksOf(id) & mark) != 0) {
      visit(static_cast<std::uint32_t>(id));
    }
  }
}

// Ids whose mark was taken away. They get it back unless Keep() was called, as
// if a call that fails had not taken it.
class TakenMarks {
 public:
  TakenMarks(BroadPhaseState& state, Bodies::Mark mark)
      : state_(state), mark_(mark), ids_(state.options.memory) {}
  TakenMarks(const TakenMarks&) = delete;
  TakenMarks& operator=(const TakenMarks&) = delete;
  ~TakenMarks();

  void Take();
  Span<const std::uint32_t> ids() const { return ids_; }
  void Keep() { ids_.Clear(); }

 private:
  BroadPhaseState& state_;
  Bodies::Mark mark_;
  List<std::uint32_t> ids_;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_
