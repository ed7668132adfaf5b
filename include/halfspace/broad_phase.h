// BroadPhase: the moving bodies of a simulation, found by queries, casts and
// pairs while other threads move them.
//
//   halfspace::AabbBroadPhase3 bodies;
//   bodies.Insert(ids, boxes);                 // ids are the caller's numbers
//   // each frame:
//   bodies.Move(moved_ids, moved_boxes);       // on any threads
//   bodies.Update();                           // now queries see the moves
//   bodies.UpdatePairs();
//   for (halfspace::IdPair pair : bodies.began()) { /* pair.a, pair.b */ }
//   for (halfspace::IdPair pair : bodies.ended()) { /* the same */ }
//   ForEachSurvivor(bodies, query_box, [](Span<const std::uint32_t> ids) {});
//
// A broad phase is a Bvh (bvh.h) with the caller's ids, and a record of each
// body that threads write while others query. A program whose frame has phases
// (move all, update, then query) needs no broad phase: a Bvh and PairEvents
// (pair_events.h) do the same without a lock (docs/design.md).
//
// Queries: those of bvh.h, bvh_shapes.h, bvh_nearest.h and bvh_pairs.h, except
// CountSurvivorsOfEach(), ForEachNearest(), Pairs() and ForEachPair(). Each
// finds every body by the bound that it had at the last Update(). With
// BroadPhaseOptions::moves_are_seen_at_once it is a bound that the body had
// during the query. The query can then see some moves of one Move() of many
// bodies, and not yet the others. And SurvivorsOfEach(), KNearest(),
// KNearestOfEach(), PairsOf() and ForEachPairOf() copy the tree if bodies have
// moved since the last Update(), and another query runs.
//
// The function of a query may take locks, run other queries and make any other
// call of the broad phase, except its destructor and assignments to it. It must
// return on the thread that called the query. If the bodies change while it
// runs, the query begins again after it. Each body that is there all the time
// is reported once. A body that moves, comes or goes is reported at most once.
// Queries with functions keep a list of what they have reported, in 8 KB of
// stack, and beyond that 4 bytes a body (8 a pair) in the memory of
// BroadPhaseOptions.
//
// Bounds are boxes or octahedra of floats in 2 or 3 dimensions. Builders
// (fit.h) return octahedra: BoundSphere(sphere) is a bound of an
// AaboBroadPhase3, and BoundSphere(sphere).aabb() one of an AabbBroadPhase3.
// NaN, empty, inverted and infinite bounds mean the same as in reject.h.
//
// Thread safety:
// - Queries, casts, PairsOf(), Move(), Has(), Get(), MasksOf(), Bounds() and
//   size() may run at any time, also at the same time as the calls below. Two
//   calls that change the same body must not run at the same time.
// - Insert(), Erase(), SetMasks(), Update(), Rebuild(), UpdatePairs(), Load(),
//   Save(), a copy, Statistics() and Validate() run one after another. Bodies
//   may move at the same time. Each waits until no query runs, except in its
//   function. Queries that begin wait for it, but not during the search of
//   UpdatePairs(), nor while Save() or a copy writes.
// - After such a call and a query have waited for each other, the next 64 calls
//   of Update(), Rebuild(), UpdatePairs(), Save() and copies go on beside
//   queries, if they change more than a 32nd of the bodies. Queries then read a
//   copy of the tree, as it was before the call, and wait only while the two
//   are exchanged. This takes 45 bytes and 1 to 2 ns a body (Zen 5). Where
//   another thread updates all the time, queries are as fast as where it only
//   moves bodies. With moves_are_seen_at_once, queries always wait.
// - An assignment to a broad phase needs it alone: no other call of it may run,
//   nor the function of one of its queries.
// - A query never waits for a query, and Move() waits for nothing. No call
//   waits for a function of a query, so each may be made under any lock.
// - The functions that these calls call (PairFilter::keep, Runner and the
//   function of Save()) must not call the broad phase, except Move(), Has() and
//   Get().
// BroadPhaseOptions::caller_locks is for programs that have a lock of their
// own.
//
// Floating-point mode: as in bvh.h. UpdatePairs() is a change: it never traps,
// and the mode has no effect. It calls PairFilter::keep in the caller's mode.
//
// Source: the mark-and-refit of moved bodies is common to Box2D's, Bullet's and
// Jolt's broad phases.
#ifndef HALFSPACE_BROAD_PHASE_H_
#define HALFSPACE_BROAD_PHASE_H_

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/bounds.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/bvh_shapes.h"
#include "halfspace/detail/broad_phase.h"
#include "halfspace/memory.h"
#include "halfspace/pair_events.h"
#include "halfspace/runner.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/visit.h"

namespace halfspace {

// A query with mask m finds a body if `category & m` is not 0, and with all
// ones every body (QueryOptions::mask). Two bodies are a pair of UpdatePairs()
// if the category of each has a bit of the other's `collides_with`.
struct BodyMasks {
  std::uint32_t category = 0xFFFFFFFF;
  std::uint32_t collides_with = 0xFFFFFFFF;

  friend bool operator==(const BodyMasks& a, const BodyMasks& b) {
    return a.category == b.category && a.collides_with == b.collides_with;
  }
  friend bool operator!=(const BodyMasks& a, const BodyMasks& b) {
    return !(a == b);
  }
};

// The caller's rule for the pairs of UpdatePairs(). `keep` is called for two
// bodies whose bounds overlap, in either order. `masks_match` is the rule of
// BodyMasks. The result replaces it. `keep` must return the same for (a, b) and
// (b, a), and the same in each call until SetMasks() of one of them. It can run
// on several threads at the same time. It must not throw, and must not call the
// broad phase, because UpdatePairs() is a change.
//
// Box2D's groups: return group[a] != 0 && group[a] == group[b] ? group[a] > 0
// : masks_match. Jolt's layers: return layer_filter.ShouldCollide(layer[a],
// layer[b]).
struct PairFilter {
  bool (*keep)(void* context, std::uint32_t a, std::uint32_t b,
               bool masks_match) = nullptr;
  void* context = nullptr;
};

struct BroadPhaseOptions {
  PairFilter filter = {};
  // The resource of all memory (memory.h). It is called by changes, by queries
  // that allocate, and by the threads of the runner of UpdatePairs(). These
  // calls can be at the same time.
  MemoryResource memory = {};
  // By default, queries see moves from the next Update() on, or from the next
  // UpdatePairs(), Rebuild(), Save() or copy on. So moves do not slow them
  // down.
  //
  // If true, a query sees each Move() that returned before it began (in the
  // sense of happens-before). It copies the bounds that moved into the tree, if
  // no other query runs, and otherwise tests these bodies one by one. Where
  // another thread moves lists of 64 bodies all the time, queries then take 30
  // to 400 times as long, and by default as long as alone (Zen 5).
  bool moves_are_seen_at_once = false;
  // If true, the broad phase has no lock: no two calls may run at the same
  // time, except calls of Move(), and queries after Update() before the next
  // Move(). Saves about 6 ns of each query.
  bool caller_locks = false;
};

struct UpdateOptions {
  static constexpr std::size_t kAutomatic = static_cast<std::size_t>(-1);

  // About how many bodies are sorted again if Bvh::CostRatio is above 1.25
  // (Bvh::RebuildPartial). 0 sorts none. If the ratio is above 2, and the
  // budget is not less than size(), all are sorted.
  //
  // kAutomatic sorts parts: size() / 16 bodies if the ratio is above 2, and
  // otherwise at most two for each body that changed since the last update that
  // sorted, and none before that is 2048 or size(). It reads the ratio when a
  // 64th of the bodies or 1024 have changed, or in the first update in which no
  // body has changed. Parts do not keep up with fast bodies. So if the ratio is
  // above 1.5, it adds up what the decay costs the searches for pairs, and
  // sorts all bodies when that is as much as a sort takes: every second frame
  // where bodies cross two of their sides in a frame. Until then it
  // sorts no parts, unless few bodies changed. The longest frame is one
  // with such a sort, 30 to 70 ns a body longer than the others (Zen 5).
  std::size_t budget = kAutomatic;
  // Runs parts of a sort (runner.h).
  Runner run = {};
};

struct BroadPhaseStatistics {
  std::size_t bodies = 0;
  std::size_t pairs = 0;  // of the last UpdatePairs()
  std::size_t bytes = 0;  // all memory
  double cost_ratio = 1;  // Bvh::CostRatio() of the tree
};

// The moving bodies of a simulation, under the caller's ids. The top of
// broad_phase.h has an example, and says which calls may run at the same time.
//
// Errors (error.h): an id is 2^31 or more, is inserted twice, or is not that of
// a body; a list is null, misaligned, or has another size than `ids`; the
// errors of bvh.h, bvh_shapes.h, bvh_nearest.h and bvh_pairs.h. The call has
// then changed nothing. A failed allocation throws std::bad_alloc. All bodies,
// their bounds, masks and pairs are then as before.
//
// Memory: boxes in 3 dimensions take 24 bytes for the bound and about 56 for
// the record and the tree, and 8 more with masks. A pair takes 8 bytes after
// the first UpdatePairs(). An id without a body takes up to 5 bytes, so ids may
// have gaps. An empty broad phase takes about 6 KB.
//
// Copies: a copy has the same bodies, masks, pairs and options, and from then
// on returns the same answers and events in the same order. An assignment to an
// object with the same options reuses its memory, so that a world can be saved
// and restored in each frame (docs/porting.md). An object that was moved from
// may only be destroyed or assigned to.
template <typename ViewType>
class BroadPhase {
 public:
  using View = ViewType;
  using Bound = typename View::Bound;
  static constexpr int kDimensions = Bound::kDimensions;
  static_assert(std::is_same_v<typename Bound::Scalar, float> &&
                    kDimensions <= 3 && detail::HasMax<Bound>,
                "broad phases are of boxes or octahedra of floats, in 2 or 3 "
                "dimensions");

  explicit BroadPhase(const BroadPhaseOptions& options = {})
      : core_(detail::BvhTypeOf<View>(), options) {}

  // Adds bodies. Ids are the caller's numbers below 2^31, such as the index of
  // a body; memory grows with the greatest. `masks` is empty, or has an element
  // for each id. Insert many bodies by one call: they are sorted together.
  void Insert(Span<const std::uint32_t> ids, Span<const Bound> bounds,
              Span<const BodyMasks> masks = {}) {
    core_.Insert(ids, detail::ValuesOfAll(bounds), masks);
  }
  void Insert(std::uint32_t id, const Bound& bound,
              const BodyMasks& masks = {}) {
    Insert({&id, 1}, {&bound, 1}, {&masks, 1});
  }

  // Removes bodies. An id that is given twice is removed once. Until the next
  // UpdatePairs(), a new body under the id of an erased one continues its
  // pairs.
  void Erase(Span<const std::uint32_t> ids) { core_.Erase(ids); }
  void Erase(std::uint32_t id) { Erase({&id, 1}); }

  // Changes the bounds of bodies. If an id is given twice, the last bound wins.
  // Writes the bodies' records and marks those whose bound has changed. Takes
  // no lock, waits for nothing and allocates nothing. 2 to 4 ns a body in a
  // list, up to 13 by itself.
  void Move(Span<const std::uint32_t> ids, Span<const Bound> bounds) {
    core_.Move(ids, detail::ValuesOfAll(bounds));
  }
  void Move(std::uint32_t id, const Bound& bound) {
    Move({&id, 1}, {&bound, 1});
  }

  // Changes the masks of bodies. The next UpdatePairs() looks at all their
  // pairs. Call it, with the same masks, if the result of PairFilter::keep
  // changes for a body.
  void SetMasks(Span<const std::uint32_t> ids, Span<const BodyMasks> masks) {
    core_.SetMasks(ids, masks);
  }
  void SetMasks(std::uint32_t id, const BodyMasks& masks) {
    SetMasks({&id, 1}, {&masks, 1});
  }

  // Call it once per frame. Copies the bounds that moved into the tree, and
  // sorts bodies again where the order has decayed. Changes no answer. Costs
  // what Bvh::Refit() of the moved bodies and Bvh::RebuildPartial() cost.
  void Update(const UpdateOptions& options = {}) { core_.Update(options); }

  // Update() that sorts all bodies.
  void Rebuild(const Runner& run = {}) { core_.Rebuild(run); }

  std::size_t size() const { return core_.size(); }
  bool empty() const { return size() == 0; }

  // An array by id with so many elements has one for each body.
  std::size_t id_limit() const { return core_.id_limit(); }

  // Whether a body has this id, which may be any number.
  bool Has(std::uint32_t id) const { return core_.Has(id); }

  // Returns a body's bound. If it is being written, waits until it is written.
  Bound Get(std::uint32_t id) const {
    detail::PlaneValues<Bound> values;
    core_.Get(id, values);
    return detail::BoundOf<Bound>(values);
  }
  BodyMasks MasksOf(std::uint32_t id) const { return core_.MasksOf(id); }

  // Returns the bound of all bodies, as Bvh::Bounds().
  Bound Bounds() const {
    detail::PlaneValues<Bound> values;
    core_.Bounds(values);
    return detail::BoundOf<Bound>(values);
  }

  // Returns whether the tree has each body once, with its bound. For tests and
  // bug reports. Must not run at the same time as Move(). O(n).
  [[nodiscard]] bool Validate() const { return core_.Validate(); }

  BroadPhaseStatistics Statistics() const { return core_.Statistics(); }

  // Finds all pairs of bodies whose bounds overlap and that the masks and the
  // filter keep. Does not need Update() before it. If a quarter of the bodies
  // or more have changed since the last call, it finds all pairs of the tree
  // (ForEachPair of bvh_pairs.h), and otherwise those of the changed bodies
  // (ForEachPairOf). pair_events.h has the cost. A body that moves during the
  // call counts as changed in the next call too.
  //
  // `run` (runner.h) runs parts of a search for all pairs. The pairs do not
  // depend on it. If it throws, the call has changed nothing.
  void UpdatePairs(const Runner& run = {}) {
    core_.UpdatePairs(detail::PairKernels<View>(), run);
  }

  // All pairs of the last UpdatePairs(), those that were not there after the
  // UpdatePairs() before, and those that were and are not now. a < b. began()
  // and ended() are sorted by a, then by b, and pairs() are in any order. A
  // pair of bodies that were erased ends. A body that was erased and inserted
  // again under its id is the same body. Valid until the next UpdatePairs() or
  // Load().
  Span<const IdPair> pairs() const { return core_.events().pairs(); }
  Span<const IdPair> began() const { return core_.events().began(); }
  Span<const IdPair> ended() const { return core_.events().ended(); }

  // Calls write(Span<const std::byte>) with the pieces of what Load() takes, in
  // order: all bodies, masks and pairs. The first 8 bytes are the size of all
  // in the byte order of the machine.
  //
  // Load() replaces the bodies, masks and pairs; the options stay. From then on
  // answers and events are those that the saved broad phase would return,
  // in the same order. Move(), Has(), Get(), MasksOf(), PairsOf() and
  // ForEachPairOf() must not run at the same time.
  // As with Bvh::FromBlob(), altered bytes can change results, but no call
  // reads or writes outside the memory of the broad phase. They can make Load()
  // allocate 2200 times their size, and 4 MB more. Errors: the bytes are not
  // from Save() of this type, byte order and format, or were cut.
  template <typename Write>
  void Save(Write&& write) const {
    core_.Save(
        [](void* context, Span<const std::byte> bytes) {
          (*static_cast<std::remove_reference_t<Write>*>(context))(bytes);
        },
        const_cast<void*>(static_cast<const void*>(&write)));
  }
  void Load(Span<const std::byte> bytes) { core_.Load(bytes); }

 private:
  friend const detail::BroadPhaseCore& detail::CoreOf<View>(
      const BroadPhase& bodies);

  detail::BroadPhaseCore core_;
};

using AabbBroadPhase2 = BroadPhase<AabbView2>;
using AabbBroadPhase3 = BroadPhase<AabbView3>;
using AaboBroadPhase2 = BroadPhase<AaboView2>;
using AaboBroadPhase3 = BroadPhase<AaboView3>;

namespace detail {

template <typename View>
const BroadPhaseCore& CoreOf(const BroadPhase<View>& bodies) {
  return bodies.core_;
}

}  // namespace detail

}  // namespace halfspace

#endif  // HALFSPACE_BROAD_PHASE_H_
