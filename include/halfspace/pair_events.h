// PairEvents: which overlaps of a BVH's objects began and ended since the last
// frame.
//
//   halfspace::PairEvents events;
//   // each frame, after the objects moved:
//   bvh.Refit(boxes);
//   bvh.RebuildPartial(bvh.size() / 16);
//   events.Update(bvh);
//   for (halfspace::IdPair pair : events.began()) { /* pair.a, pair.b */ }
//   for (halfspace::IdPair pair : events.ended()) { /* the same */ }
//
// If only some objects changed, pass their ids:
//
//   bvh.Set(moved_ids, moved_boxes);
//   events.Update(bvh, moved_ids);
//
// PairEvents keeps the pairs of the last Update(), in 8 to 12 bytes each. An
// Update() finds the pairs of the BVH now (bvh_pairs.h, which says when two
// bounds overlap) and compares the two lists. No bound is kept, so the margin
// of a fat AABB is not needed.
//
// An engine that moves its bodies, then updates, then queries, needs no more
// than a Bvh and PairEvents. BroadPhase (broad_phase.h) is for moves and
// queries at the same time.
//
// Errors (error.h): those of bvh_pairs.h, except that `changed` may have ids
// without an object. A failed allocation throws std::bad_alloc. After any
// exception the pairs and events are as before the call.
//
// Thread safety: const calls may run at the same time. Update() uses the BVH
// as a query does, so the BVH must not change at the same time.
//
// Floating-point mode: as that of a change in bvh.h. Update() never traps, and
// the mode has no effect.
//
// Cost: that of the search (bvh_pairs.h), and 1.1 to 1.6 times as long in total
// if all objects move a little. With a list of ids, the search costs as
// PairsOf(), and each pair of the last Update() takes 0.4 to 1 ns. Such a call
// uses up to 24 KiB of stack. With a list of about ten ids, it allocates memory
// only for the pairs that began or ended.
#ifndef HALFSPACE_PAIR_EVENTS_H_
#define HALFSPACE_PAIR_EVENTS_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/bvh.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/detail/pair_events.h"
#include "halfspace/memory.h"
#include "halfspace/runner.h"
#include "halfspace/span.h"
#include "halfspace/target.h"

namespace halfspace {

// Options of PairEvents::Update().
struct PairEventOptions {
  // Those of PairOptions. With a list of ids, only the pairs of these objects
  // are searched by a new mask or margin.
  std::uint32_t mask = 0xFFFFFFFF;
  float margin = 0;
  // Runs parts of a search of many objects, for example on several threads
  // (runner.h). The pairs and events do not depend on it. The memory resources
  // of the PairEvents and of the BVH are used by one thread at a time.
  Runner run = {};
  Target target = {};  // by default, the chosen one (targets.h)
};

// The pairs of a BVH at the last Update(), and the difference to the pairs of
// the Update() before. The top of pair_events.h has examples. Copies, moves and
// swap(a, b) use memory as the other owners do (memory.h).
class PairEvents {
 public:
  PairEvents() : PairEvents(MemoryResource()) {}
  explicit PairEvents(const MemoryResource& memory) : core_(memory) {}
  PairEvents(const PairEvents& other, const MemoryResource& memory)
      : core_(other.core_, memory) {}
  friend void swap(PairEvents& a, PairEvents& b) noexcept {
    swap(a.core_, b.core_);
  }

  const MemoryResource& memory() const { return core_.memory(); }
  // The size of all memory. During Update() it is about twice as much.
  std::size_t bytes() const { return core_.bytes(); }

  // Finds all pairs of the BVH. BVHs are of boxes or octahedra.
  template <typename View>
  void Update(const Bvh<View>& bvh, const PairEventOptions& options = {}) {
    core_.Update(detail::PairsIn(bvh), options);
  }

  // Finds the pairs of the objects in `changed`, and keeps the pairs of the
  // others. `changed` must have the ids of all objects that were inserted,
  // changed or erased since the last Update(), once or more often. The pairs of
  // an erased object end. If `changed` has a quarter as many ids as the BVH
  // has objects, the call finds all pairs, which takes less time. Otherwise
  // a new mask or margin counts for the pairs of `changed` alone.
  template <typename View>
  void Update(const Bvh<View>& bvh, Span<const std::uint32_t> changed,
              const PairEventOptions& options = {}) {
    core_.Update(detail::PairsIn<View>(bvh, nullptr, &changed), options);
  }

  // The pairs of the last Update(), with a < b, each once, in any order. Valid
  // until the next change of this PairEvents, as the two lists below.
  Span<const IdPair> pairs() const { return core_.pairs(); }
  std::size_t size() const { return pairs().size(); }
  bool empty() const { return size() == 0; }

  // The pairs that are in pairs() and were not before the last Update(), and
  // the pairs that were and are not. a < b. Sorted by a, then by b, so two
  // programs with the same BVHs get equal lists, whatever they called before.
  Span<const IdPair> began() const { return core_.began(); }
  Span<const IdPair> ended() const { return core_.ended(); }

  // Removes all pairs and events. Frees all memory.
  void Clear() { core_.Clear(); }

  // Sets the pairs, in any order, and removes all events: the next Update()
  // returns the differences to these. Store pairs() with a BVH (Bvh::Blob),
  // and load both, to go on as the stored ones would. A pair of ids that the
  // BVH does not have ends at one of the next calls of Update(). Throws
  // (error.h) if a pair does not have a < b and b < 4294967295, or is in the
  // list twice.
  void Load(Span<const IdPair> pairs) { core_.Load(pairs); }

 private:
  detail::PairEventsCore core_;
};

}  // namespace halfspace

#endif  // HALFSPACE_PAIR_EVENTS_H_
