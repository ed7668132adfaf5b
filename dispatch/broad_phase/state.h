// The state of a broad phase: the records of its bodies, which Move() writes, a
// tree of all bodies, and the pairs of the last UpdatePairs().
//
// Queries read the tree under the lock of readers. The tree is written where no
// query may read it. A flush copies the bounds of bodies with a mark from their
// records into the tree. Where queries and updates have met, queries read a
// copy of the tree during an update. docs/design.md says who may run at the
// same time, and why no change is lost.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "dispatch/broad_phase/lock.h"
#include "dispatch/broad_phase/records.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "halfspace/broad_phase.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/pair_events.h"

namespace halfspace::detail {

// What Update() has not sorted yet, and what that has cost.
struct Wear {
  // Changes that Update() has not sorted for yet, without those of the set
  // Records::kForOrder.
  std::uint32_t changes = 0;
  // With changes, since all were sorted.
  std::uint32_t updates = 0;
  // What the decay of the order has cost since all were sorted, in searches for
  // all pairs in the order as sorted.
  double cost = 0;
};

class BroadPhaseState {
 public:
  BroadPhaseState(const BvhType& its_type, const BroadPhaseOptions& with)
      : type(its_type),
        options(with),
        records(with.memory, its_type.plane_count),
        tree(its_type, with.memory),
        tree_copy(its_type, with.memory),
        events(with.memory),
        changed_slots(BlockAllocator<std::uint64_t>(with.memory)),
        collides_with(BlockAllocator<std::uint32_t>(with.memory)) {}
  BroadPhaseState(const BroadPhaseState&) = delete;
  BroadPhaseState& operator=(const BroadPhaseState&) = delete;

  std::size_t planes() const { return type.plane_count; }

  // Throws, in the name of `call`, unless both arrays can be read and `others`
  // has an element for each id. Reads no id.
  void CheckList(const char* call, Span<const std::uint32_t> ids,
                 const char* name, const void* others, std::size_t other_count,
                 std::size_t alignment) const;
  // Throws unless bodies have all these ids.
  void CheckBodies(const char* call, Span<const std::uint32_t> ids) const;

  // With the right to change.
  BlockVector<std::uint32_t> IdsOf(Records::ChangedSet set,
                                   const MemoryResource& memory) const;

  // The tree, or its copy, must not change at the same time.
  BodyMasks MasksOf(std::uint32_t id) const { return MasksOf(tree, id); }
  BodyMasks MasksOf(const BvhTree& of, std::uint32_t id) const {
    const BvhLevels& levels = of.levels();
    const std::uint32_t* const categories = levels.level[0].masks;
    BodyMasks masks;
    if (categories != nullptr) masks.category = categories[levels.slots[id]];
    if (id < collides_with.size()) masks.collides_with = collides_with[id];
    return masks;
  }

  // With the right to change, and while no query may read `tree`. Copies the
  // bounds of bodies with a mark into it. Allocates nothing.
  void Flush();
  // Takes the bodies of a tree. The state must have no bodies.
  void Adopt(BvhTree its_tree);
  // Becomes a copy, in its own memory as far as that is enough. Needs exclusive
  // access, and the right to change the other, which has been flushed and has
  // the same type. If it throws, nothing has changed.
  void Assign(const BroadPhaseState& from);
  // Needs exclusive access to both. Does not swap the options.
  void Swap(BroadPhaseState& other);

  // Needs exclusive access. Allocates the memory of Flush() for so many slots.
  void ReserveChanges(std::size_t slots) {
    changed_slots.resize(BvhState::WordsOfChanges(slots));
  }

  const BvhType type;
  const BroadPhaseOptions options;
  mutable ReadersLock lock;
  Records records;
  std::atomic<std::size_t> size{0};

  // Written with exclusive access. Each change has a version of its own.
  std::uint64_t version = 0;
  BvhTree tree;
  // The tree that queries read: `tree`, or during an update `tree_copy`.
  const BvhTree* shown = &tree;
  BvhTree tree_copy;
  // How many of the next updates may go on beside queries.
  std::uint32_t beside = 0;
  PairEventsCore events;
  Wear wear;
  // Whether an Update() with an automatic budget would compute the cost ratio
  // again and sort nothing, because no body has changed since the last one.
  bool needs_no_sort = false;
  // A bit for each slot and each node of the tree: room for Flush().
  BlockVector<std::uint64_t> changed_slots;
  // By id. Empty until a body gets a mask that is not all ones.
  BlockVector<std::uint32_t> collides_with;

 private:
  template <std::size_t kAxes, typename BitsOf>
  void CopyBlocks(std::size_t begin, std::size_t end, const BitsOf& bits_of);
  template <std::size_t kAxes>
  void FlushAll();
  template <std::size_t kAxes>
  void FlushSome(std::size_t count);
};

// A query, during the life of an object of this class. It finds each body by a
// bound that the body had during that time.
class Reading {
 public:
  // Flushes, if the query has to see moves and no other query runs.
  explicit Reading(BroadPhaseState& state);
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;
  ~Reading() {
    if (is_in_) Leave();
  }

  // Calls a function of the caller's, which may do anything, without the lock.
  // Returns false if the tree has changed: then what was read of it is wrong,
  // and the query must begin again.
  template <typename Function>
  bool CallOutside(const Function& function) {
    const std::uint64_t version = state_.version;
    Leave();
    function();
    Enter();
    return version == state_.version;
  }

  const BvhTree& tree() const { return *state_.shown; }
  // Whether the tree has the bounds of all bodies. Otherwise some are late.
  bool is_exact() const { return is_exact_; }
  bool IsLate(std::uint32_t id) const {
    return state_.records.IsLate(id, time_);
  }

 private:
  void Enter() {
    if (!state_.options.caller_locks) state_.lock.Enter(line_);
    is_in_ = true;
  }
  void Leave() {
    is_in_ = false;
    if (!state_.options.caller_locks) state_.lock.Leave(line_);
  }

  BroadPhaseState& state_;
  const std::size_t line_;
  bool is_in_ = false;
  bool is_exact_ = true;
  std::uint32_t time_ = 0;
};

// The right to change, during the life of an object of this class.
class Changing {
 public:
  // With exclusive access, or with what Begin() says for a change of all bodies
  // that have a mark.
  explicit Changing(BroadPhaseState& state) : Changing(state, Locked()) {
    Close();
  }
  enum AllMarked : std::uint8_t { kAllMarked };
  Changing(BroadPhaseState& state, AllMarked) : Changing(state, Locked()) {
    if (state.beside != 0 || state.lock.HasWaits()) [[unlikely]] {
      BeginBeside();
    } else {
      Close();
    }
  }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;
  ~Changing() {
    ShowTree();
    if (HasLock()) state_.lock.Unlock();
  }

  // Lets the caller change the bounds and the order of so many bodies: with
  // exclusive access, or, where it takes long and queries would wait, while
  // queries read a copy of the tree as it was. Can be called again, for more
  // bodies. May allocate.
  void Begin(std::size_t bodies) {
    if (state_.beside != 0) [[unlikely]] {
      BeginBeside(bodies);
    } else {
      Close();
    }
  }
  // Ends exclusive access. Queries read the tree.
  void ShowTree() {
    if (state_.shown != &state_.tree) Show(state_.tree);
    Open();
  }

 private:
  struct Locked {};
  Changing(BroadPhaseState& state, Locked) : state_(state) {
    if (HasLock()) state_.lock.Lock();
  }
  void BeginBeside();
  void BeginBeside(std::size_t bodies);
  bool HasLock() const { return !state_.options.caller_locks; }
  void Close() {
    if (is_closed_) return;
    if (HasLock()) state_.lock.Close();
    ++state_.version;
    is_closed_ = true;
  }
  void Open() {
    if (is_closed_ && HasLock()) state_.lock.Open();
    is_closed_ = false;
  }
  void Show(const BvhTree& tree) {
    Close();
    state_.shown = &tree;
    Open();
  }

  BroadPhaseState& state_;
  bool is_closed_ = false;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_STATE_H_
