// What a broad phase owns: a record of each body, and versions of the tree.
//
// Readers (queries and moves) hold a version by a counter in it. A writer, who
// has the mutex, builds the next version beside the current one, announces it
// as `upcoming`, and then makes it the current one. It reuses a version when
// its counters are 0. The counters are never freed, so a reader may count
// itself into a version that was just replaced, sees that, and tries again.
//
// No body is lost between two versions:
// - A mover writes the body's record, then counts itself into the current
//   version C, then loads `is_building` and `upcoming`. In each version that it
//   sees, it widens the body if its bound there does not enclose it, or if
//   there is no margin. Before that, or if it saw `is_building`, it marks the
//   body with kMoved. After the
//   last mark it changes its counter again. It ends when neither pointer shows
//   it another version.
// - A writer sets `is_building`, then reads all counters of C. It copies the
//   tree of C, and computes the bounds of the bodies that had a mark from their
//   records. It stores `upcoming` = N, then reads all counters of C again, then
//   widens each body in N that has a mark, then makes N the current version.
// Stores and loads of the pointers, of `is_building` and of the counters are
// sequentially consistent, but for the store by which a thread leaves a counter
// of its own. A counter is changed only by read-modify-write, or by stores of
// one thread that release, so the writer's read synchronizes with a mover's
// change before it. If the mover did not see `is_building`, it counted itself
// before the first read, so the writer computes bounds from a record that is as
// new. Bounds without a mark are those of C, which enclose the body. If the
// mover marked the body and did not see N, it changed its counter before the
// second read, so the writer sees the mark.
//
// No pair is lost. UpdatePairs() keeps candidates: each pair of bodies whose
// bounds in the tree overlap. It finds those of a body again if the body has
// the mark kNewPairs. A bound in the tree that grows in place gets this mark
// before and after it grows, and one that Update() computes gets it before its
// version is the current one. So without the mark, the bound is as it was when
// the candidates were found. A body that moves inside its bound, with a margin
// and while no version is built, has only the mark kTouched, and UpdatePairs()
// tests its candidates.
//
// In a version that readers can see, the floats of the tree change only by
// atomic stores, and only outward: minima become less, maxima greater. The one
// exception is a mover's store of its body's plane, which may take back what a
// writer stored for an older bound of the body. It encloses the record that the
// mover wrote before. The nodes stay as they are. So a walk sees for each body
// the bound that enclosed it when the walk began, or a larger one. The kernels
// read the floats by vector loads that are not atomic. On the supported
// machines no aligned 32-bit lane of a vector load is torn, and a lane is the
// old or the new value. The copy of a tree relies on the same. The thread
// sanitizer cannot know this: see WithRacyReads.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <type_traits>
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

// Calls function(axes) with a constant: loops over the axes have no branches.
template <typename Function>
auto WithAxes(std::size_t axes, const Function& function) {
  switch (axes) {
    case 2:
      return function(std::integral_constant<std::size_t, 2>());
    case 3:
      return function(std::integral_constant<std::size_t, 3>());
    default:
      return function(std::integral_constant<std::size_t, 4>());
  }
}

// A record of each id: its exact bound and its masks, which are read and
// written together, and marks of what changed. A record has one writer at a
// time.
class Bodies {
 public:
  enum Mark : std::uint8_t {
    // Its bound in the tree may no longer be that of Update(), or it was
    // erased.
    kMoved = 1,
    // Its bound in the tree or its masks are new to UpdatePairs().
    kNewPairs = 2,
    // In the list of a call, while the call checks it.
    kListed = 4,
    // Was erased since the tree was tightened.
    kReplaced = 8,
    // Moved since the last UpdatePairs(). In other bytes than the marks above.
    kTouched = 128,
  };

  Bodies(const MemoryResource& memory, std::size_t ids, std::size_t planes);

  std::size_t bytes() const;

  bool Has(std::size_t id) const {
    return (At(id)[0].load(std::memory_order_acquire) & kPresent) != 0;
  }
  // Of the bound, which is in one line or in two.
  void Prefetch(std::size_t id) const {
    kernels::Prefetch(At(id));
    kernels::Prefetch(At(id) + planes_);
  }
  // Returns whether the body exists, and all of its record as it was at one
  // time: its masks too unless that is not wanted.
  bool Read(std::size_t id, Body& body, bool has_masks = true) const {
    return ReadPlanes(id, planes_, body, has_masks);
  }
  // The same with the number of planes, which may be a constant.
  bool ReadPlanes(std::size_t id, std::size_t planes, Body& body,
                  bool has_masks) const {
    const std::atomic<std::uint32_t>* const words = words_ + id * (1 + planes);
    for (std::size_t tries = 1;; ++tries) {
      const std::uint32_t before = words[0].load(std::memory_order_acquire);
      if ((before & kIsWritten) == 0) {
        if ((before & kPresent) == 0) return false;
        for (std::size_t p = 0; p < planes; ++p) {
          body.planes[p] = std::bit_cast<float>(
              words[1 + p].load(std::memory_order_acquire));
        }
        if (has_masks) ReadMasks(id, body.masks);
        if (words[0].load(std::memory_order_relaxed) == before) return true;
      }
      Wait(tries);
    }
  }

  // Whether two bodies exist and overlap, in the default floating-point mode
  // and within WithRacyReads: the loads of vectors are not atomic. Loads of
  // floats take UpdatePairs() 1.6 times as long.
  template <std::size_t kAxes>
  [[gnu::always_inline]] bool DoOverlap(std::uint32_t a,
                                        std::uint32_t b) const {
    const std::atomic<std::uint32_t>* const of_a = words_ + a * kWordsOf<kAxes>;
    const std::atomic<std::uint32_t>* const of_b = words_ + b * kWordsOf<kAxes>;
    const std::uint32_t before_a = of_a[0].load(std::memory_order_acquire);
    const std::uint32_t before_b = of_b[0].load(std::memory_order_acquire);
    // What is behind the last record are masks.
    const auto is_apart = (LoadFour(of_a + 1) > LoadFour(of_b + 1 + kAxes)) |
                          (LoadFour(of_b + 1) > LoadFour(of_a + 1 + kAxes));
#ifndef HALFSPACE_THREAD_SANITIZER  // which knows no fences
    std::atomic_thread_fence(std::memory_order_acquire);
#endif
    const bool is_read = ((before_a | before_b) & kIsWritten) == 0 &&
                         (before_a & before_b & kPresent) != 0 &&
                         of_a[0].load(std::memory_order_relaxed) == before_a &&
                         of_b[0].load(std::memory_order_relaxed) == before_b;
    if (!is_read) [[unlikely]] {
      return DoOverlapSlowly(a, b);
    }
    std::uint64_t halves[2];
    std::memcpy(halves, &is_apart, sizeof(halves));
    constexpr std::uint64_t kAll = ~std::uint64_t{0};
    constexpr std::uint64_t kFirst =
        std::endian::native == std::endian::little ? kAll >> 32 : kAll << 32;
    constexpr std::uint64_t kOfSecond = kAxes == 2   ? 0
                                        : kAxes == 3 ? kFirst
                                                     : kAll;
    return (halves[0] | (halves[1] & kOfSecond)) == 0;
  }

  void Write(std::size_t id, const float* planes, const BodyMasks* masks,
             bool is_present);
  // Writes the planes of bodies, one after another, and touches them.
  void Move(Span<const std::uint32_t> ids, const float* planes);

  void AddMark(std::size_t id, std::uint8_t marks) {
    ByteOf(marks_, id).fetch_or(marks);
  }
  void TakeMark(std::size_t id, Mark mark) {
    ByteOf(marks_, id).fetch_and(static_cast<std::uint8_t>(~mark));
  }
  // Not a read-modify-write, so faster. The caller must be the only thread that
  // writes marks of this id: it has the mutex, and no other call changes the
  // body. Returns whether the body had one of the marks.
  bool AddMarkAlone(std::size_t id, std::uint8_t marks) {
    const auto byte = ByteOf(marks_, id);
    const auto old = byte.load(std::memory_order_relaxed);
    byte.store(old | marks, std::memory_order_release);
    return (old & marks) != 0;
  }
  void TakeMarkAlone(std::size_t id, Mark mark) {
    const auto byte = ByteOf(marks_, id);
    const auto old = byte.load(std::memory_order_relaxed);
    byte.store(old & static_cast<std::uint8_t>(~mark),
               std::memory_order_release);
  }
  // Replaces all marks except kReplaced. A mark that another thread takes away
  // at the same time can stay.
  void SetMarks(std::size_t id, std::uint8_t marks) {
    const auto byte = ByteOf(marks_, id);
    const auto old = byte.load(std::memory_order_relaxed);
    byte.store(marks | (old & kReplaced), std::memory_order_release);
  }
  bool HasMarks(std::size_t id, std::uint8_t marks) const {
    return (ByteOf(marks_, id).load(std::memory_order_acquire) & marks) ==
           marks;
  }
  // There is no other mark in the byte, so it is no read-modify-write.
  void Touch(std::size_t id) {
    ByteOf(touched_, id).store(kTouched, std::memory_order_release);
  }
  // The bodies from 64 * `word` on that have the mark kMoved, a bit for each.
  std::uint64_t MovedOf(std::size_t word) const;
  // The same, and takes the mark away.
  std::uint64_t TakeMoved(std::size_t word);
  // A mark of eight bodies, in the bytes of a word.
  static constexpr std::uint64_t EightOf(Mark mark) {
    return mark * std::uint64_t{0x0101010101010101};
  }
  // Takes kNewPairs and kTouched away from the bodies from 8 * `word` on.
  // Returns a byte for each.
  std::uint64_t TakePairMarks(std::size_t word);

 private:
  // The first word of a record counts its writes, above two bits.
  static constexpr std::uint32_t kIsWritten = 1;
  static constexpr std::uint32_t kPresent = 2;
  static constexpr std::uint32_t kOneWrite = 4;
  static constexpr std::size_t kMaskWords = 4;

  // A word that counts writes, and the bound.
  std::atomic<std::uint32_t>* At(std::size_t id) const {
    return words_ + id * (1 + planes_);
  }
  // A mark is written as a byte, and read as one of eight. On the supported
  // machines these are atomic to each other.
  static std::atomic_ref<unsigned char> ByteOf(std::uint64_t* marks,
                                               std::size_t id) {
    return std::atomic_ref<unsigned char>(
        reinterpret_cast<unsigned char*>(marks)[id]);
  }
  std::atomic<std::uint32_t>* MasksAt(std::size_t id) const {
    return masks_ + id * kMaskWords;
  }
  template <std::size_t kAxes>
  static constexpr std::size_t kWordsOf = 1 + 2 * kAxes;
  // Of which the first are the minima or the maxima of a body.
  using Four [[gnu::vector_size(16)]] = float;
  [[gnu::always_inline]] static Four LoadFour(
      const std::atomic<std::uint32_t>* words) {
    Four four;
    std::memcpy(&four, static_cast<const void*>(words), sizeof(four));
    return four;
  }
  // If one of the bodies does not exist or is being written.
  bool DoOverlapSlowly(std::uint32_t a, std::uint32_t b) const;
  // Parts of Read(). The loads of the values acquire, so that they stay before
  // the second load of the first word. The sanitizers know no fences.
  void ReadMasks(std::size_t id, BodyMasks& masks) const;
  static void Wait(std::size_t tries);

  std::size_t ids_;
  std::size_t planes_;
  std::size_t words_of_marks_;
  Scratch memory_;
  std::uint64_t* marks_;    // a byte for each id
  std::uint64_t* touched_;  // the same
  std::atomic<std::uint32_t>* words_;
  std::atomic<std::uint32_t>* masks_;
};

// A tree, and the bodies that are not in it yet.
//
// Without a margin most bounds in the tree are the bodies' own. A mark of each
// such body lets queries answer by the tree alone. A writer sets it before
// readers can see the version. Who changes the body takes it away before the
// bound in the tree changes, and no one sets it again. So a reader that loads
// planes of the tree, and then finds the mark, has a bound that the body had.
class Version {
 public:
  // Bodies that wait for the next tree. Each query tests them.
  static constexpr std::size_t kMostPending = 256;

  // There is memory for `marks` marks behind the object.
  Version(BvhTree empty, std::size_t marks)
      : tree(std::move(empty)),
        own_bounds_(reinterpret_cast<std::atomic<std::uint8_t>*>(this + 1)),
        own_bound_count_(marks) {
    std::uninitialized_default_construct_n(own_bounds_, marks);
  }

  // A reader counts itself in and out of a counter of its thread's. The first
  // threads of the program have counters of their own, which they leave without
  // a barrier. A query would wait longer for it than for a leaf.
  void Enter(std::size_t counter) {
    std::atomic<std::uint32_t>& readers = counters_[counter].readers;
    if (counter < kOwnCounters) {
      readers.exchange(readers.load(std::memory_order_relaxed) + 1,
                       std::memory_order_seq_cst);
    } else {
      readers.fetch_add(1, std::memory_order_seq_cst);
    }
  }
  void Leave(std::size_t counter) {
    std::atomic<std::uint32_t>& readers = counters_[counter].readers;
    if (counter < kOwnCounters) {
      readers.store(readers.load(std::memory_order_relaxed) - 1,
                    std::memory_order_release);
    } else {
      readers.fetch_sub(1, std::memory_order_seq_cst);
    }
  }
  // So that a writer who reads the counters sees what this thread did before.
  void CountAgain(std::size_t counter) {
    counters_[counter].readers.fetch_add(0, std::memory_order_seq_cst);
  }
  // Reads all counters.
  bool HasReaders() const;
  static std::size_t CounterOfThread() {
    return counter_of_thread_ != 0 ? counter_of_thread_ - 1 : NewCounter();
  }

  std::size_t PendingCount() const {
    return pending_count_.load(std::memory_order_acquire);
  }
  std::uint32_t Pending(std::size_t i) const {
    return pending_[i].load(std::memory_order_relaxed);
  }
  bool IsPending(std::uint32_t id) const;
  void AddPending(std::uint32_t id);
  void ClearPending() { pending_count_.store(0, std::memory_order_release); }

  // Whether the body's bound in the tree is its own. `id` is in the tree.
  bool HasOwnBounds() const { return own_bound_count_ != 0; }
  bool HasOwnBound(std::uint32_t id) const {
    return own_bound_count_ != 0 &&
           own_bounds_[id].load(std::memory_order_acquire) != 0;
  }
  void SetOwnBound(std::uint32_t id, bool is_own) {
    if (own_bound_count_ == 0) return;
    own_bounds_[id].store(is_own ? 1 : 0, std::memory_order_relaxed);
  }
  // Of the ids below `count`.
  void CopyOwnBounds(const Version& from, std::size_t count);
  // Where the first plane of a body is in the tree, or null.
  float* Find(std::uint32_t id) const;
  // Of up to 64 bodies, a bit for each that the tree does not have, or not with
  // a bound that encloses its planes, which are one after another, or that has
  // a NaN. This and the next are called in the default floating-point mode.
  std::uint64_t NotEnclosed(Span<const std::uint32_t> ids,
                            const float* planes) const;
  // Makes the body's bound in the tree, and the nodes, enclose `planes`. While
  // readers walk. A mover, who is the only one that moves the body, replaces
  // planes of its bound that another thread made grow for it.
  void Widen(std::uint32_t id, const float* planes, bool is_mover);
  // Whether the body's bound in the tree and all its nodes do.
  bool DoAllEnclose(std::uint32_t id, const float* planes) const;

  BvhTree tree;
  Version* next = nullptr;  // in the list of all

 private:
  static constexpr std::size_t kOwnCounters = 16;
  static constexpr std::size_t kCounters = 2 * kOwnCounters;
  static std::size_t NewCounter();
  // 1 more than its number, or 0 of a new thread.
  static constinit inline thread_local std::size_t counter_of_thread_ = 0;

  struct alignas(64) Counter {
    std::atomic<std::uint32_t> readers{0};
  };

  std::atomic<std::uint32_t> pending_count_{0};
  std::atomic<std::uint32_t> pending_[kMostPending];
  Counter counters_[kCounters];
  std::atomic<std::uint8_t>* const own_bounds_;
  const std::size_t own_bound_count_;
};

class BroadPhaseState {
 public:
  BroadPhaseState(const BvhType& tree_shape, std::size_t ids,
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

  // Whether a body was ever given other masks than those of BodyMasks(). Who
  // took the mark kNewPairs of such a body sees it.
  bool HasMasks() const { return has_masks.load(std::memory_order_acquire); }
  void AddMasks(const BodyMasks& masks) {
    if (masks != BodyMasks()) has_masks.store(true, std::memory_order_release);
  }

  const BvhType shape;
  const std::size_t max_ids;
  const BroadPhaseOptions options;
  const bool has_margin;
  Bodies bodies;
  std::atomic<std::size_t> size{0};
  std::atomic<Version*> current;
  std::atomic<Version*> upcoming{nullptr};
  std::atomic<bool> is_building{false};
  std::atomic<bool> has_masks{false};

  // The rest belongs to who has the mutex.
  std::mutex mutex;
  Version* versions = nullptr;
  std::size_t id_limit = 0;  // above all ids that were ever in use
  // Updates that did nothing since the last one, though bodies had moved.
  std::size_t deferred = 0;
  List<std::uint64_t> candidates;  // keys of pairs.cc
  std::size_t pairs = 0;           // of these

  Version* NewVersion();
  std::size_t MarksOfVersion() const { return has_margin ? 0 : max_ids; }
  std::size_t BytesOfVersion() const {
    return sizeof(Version) + MarksOfVersion();
  }
  // A bound of a body for a tree: larger by the margin, and more where the body
  // goes, as far as its planes in a tree, or null, show. In the default
  // floating-point mode.
  void Loosen(float* in_tree, const float* planes, float* loose) const;
};

void CheckMargin(const char* call, const char* name, float margin);
// In any floating-point mode: a compare would flush a subnormal margin.
inline bool IsMargin(float margin) {
  return std::bit_cast<std::uint32_t>(margin) << 1 != 0;
}

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

// A set of ids, a bit for each.
class IdSet {
 public:
  explicit IdSet(const MemoryResource& memory) : words_(memory) {}

  bool Has(std::uint32_t id) const {
    return (words_[id / 64] >> id % 64 & 1) != 0;
  }
  std::size_t size() const {
    std::size_t count = 0;
    for (const std::uint64_t word : words_) {
      count += static_cast<std::size_t>(std::popcount(word));
    }
    return count;
  }
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    for (std::size_t w = 0; w < words_.size(); ++w) {
      for (std::uint64_t bits = words_[w]; bits != 0; bits &= bits - 1) {
        visit(static_cast<std::uint32_t>(
            64 * w + static_cast<std::size_t>(std::countr_zero(bits))));
      }
    }
  }

 protected:
  List<std::uint64_t> words_;
};

// Takes kMoved from ids. The destructor returns the marks unless Keep() was
// called, so a call that fails changes none.
class TakenMarks : public IdSet {
 public:
  explicit TakenMarks(BroadPhaseState& state)
      : IdSet(state.options.memory), state_(state) {}
  TakenMarks(const TakenMarks&) = delete;
  TakenMarks& operator=(const TakenMarks&) = delete;
  ~TakenMarks();

  void Take();
  void Keep() { is_kept_ = true; }

 private:
  BroadPhaseState& state_;
  bool is_kept_ = false;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_
