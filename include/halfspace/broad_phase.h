// BroadPhase: the moving bodies of a simulation, found by queries, casts and
// pairs while other threads move them.
//
//   halfspace::AabbBroadPhase3 bodies(max_bodies);
//   bodies.Insert(ids, boxes);                 // ids are the caller's numbers
//   // each frame:
//   bodies.Move(moved_ids, moved_boxes);       // on any threads
//   bodies.Update();
//   bodies.UpdatePairs([](std::uint32_t a, std::uint32_t b) { /* began */ },
//                      [](std::uint32_t a, std::uint32_t b) { /* ended */ });
//   bodies.ForEach(query_box, ~std::uint64_t{0},  // all categories
//                  [](std::uint32_t id, const halfspace::Aabb3& box) {});
//
// Bounds are boxes or octahedra of floats in 2 or 3 dimensions. Builders
// (fit.h) return octahedra: BoundSphere(sphere) is a bound of an
// AaboBroadPhase3, and BoundSphere(sphere).aabb() one of an AabbBroadPhase3.
//
// A broad phase keeps the bound of each body, and a BVH (bvh.h) of bounds that
// are larger by a margin. The margin and the history change no answer. A query
// finds the bodies that it would find in a Bvh of the bodies' own bounds, each
// at most once. A cast finds the same t. NaN, empty, inverted and infinite
// bounds mean the same as in reject.h.
//
// Thread safety:
// - Queries, casts, ForEachPairOf(), Has(), Get(), MasksOf(), Bounds() and
//   size() may run at any time. So may Move() and SetMasks(). Two calls that
//   change the same body, Insert() and Erase() included, must not run at the
//   same time.
// - Insert(), Erase(), Update(), Rebuild(), UpdatePairs() and Statistics() may
//   run on any thread, at the same time as the calls above. They wait for each
//   other. They do not wait for queries or moves.
// - Validate() must not run at the same time as Move().
//
// Floating-point mode: as in bvh.h.
//
// Source: the larger bounds of Box2D's and Bullet's dynamic trees.
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
#include "halfspace/runner.h"
#include "halfspace/shapes.h"
#include "halfspace/span.h"
#include "halfspace/visit.h"

namespace halfspace {

// A query with mask m finds a body if `category & m` is not 0, and with all
// ones every body. Two bodies are a pair if the category of each has a bit of
// the other's `collides_with`.
struct BodyMasks {
  std::uint64_t category = 1;
  std::uint64_t collides_with = ~std::uint64_t{0};

  friend bool operator==(const BodyMasks& a, const BodyMasks& b) {
    return a.category == b.category && a.collides_with == b.collides_with;
  }
  friend bool operator!=(const BodyMasks& a, const BodyMasks& b) {
    return !(a == b);
  }
};

// The caller's rule for pairs. `keep` is called for two bodies whose bounds
// overlap, or are near each other, in either order. `masks_match` is the rule
// of BodyMasks. The result replaces it. `keep` must return the same for (a, b)
// and (b, a), and the same in each call until SetMasks() of one of them. It can
// run on several threads at the same time. It must not throw, and must not call
// the broad phase, because UpdatePairs() calls it with the lock of all changes.
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
  // The bounds in the tree are larger than the bodies' by this on each side,
  // and by up to four times this on a side to which the body moves. A body
  // that stays inside costs a comparison in Move() and a test of its pairs in
  // UpdatePairs(). Each query tests more bodies with a large margin. A tenth of
  // a body's size is usual. A body should need several calls of Update() to
  // move so far. With 0, most bounds in the tree are the bodies' own, and a
  // query takes about as long as that of a Bvh. Must be finite and not
  // negative.
  //
  // The margin should be less than the distance between most bodies, also if
  // some bodies are large. UpdatePairs() keeps each two bodies whose larger
  // bounds overlap, so beyond this distance its memory and time grow as the
  // square of the number of bodies. 16 000 bodies that have no pair, all within
  // the margin of each other, take 1.0 GB, and 3 GB during UpdatePairs().
  float margin = 0;
  PairFilter filter = {};
  // The resource of all memory (memory.h). It is called by the threads that
  // change the broad phase, by ForEachPairOf(), and by the threads of the
  // runner of UpdatePairs(). These calls can be at the same time.
  MemoryResource memory = {};
};

struct UpdateOptions {
  static constexpr std::size_t kAutomatic = static_cast<std::size_t>(-1);

  // About how many bodies are sorted again if Bvh::CostRatio is above 1.25:
  // those whose order has decayed most, and at least 4096. 0 sorts none.
  // kAutomatic is size() / 16. If the ratio is above 2, and the budget is not
  // less than size(), all are sorted as by Rebuild().
  std::size_t budget = kAutomatic;
  // Used when all are sorted (runner.h).
  Runner run = {};
};

struct BroadPhaseStatistics {
  std::size_t bodies = 0;
  // Bodies that are not in the tree yet. Each query tests all of them.
  std::size_t pending = 0;
  std::size_t pairs = 0;  // of the last UpdatePairs()
  // Trees in memory: 1, and those that queries still read.
  std::size_t trees = 0;
  std::size_t bytes = 0;  // all memory
  double cost_ratio = 1;  // Bvh::CostRatio() of the tree
};

// The moving bodies of a simulation, under the caller's ids. The top of
// broad_phase.h has an example, and says which calls may run at the same time.
//
// Errors (error.h): `max_ids` is more than 2^29; the margin is negative or not
// finite; an id is not below max_ids(), is inserted twice, or is not that of a
// body; a list is null, misaligned, or has another size than `ids`; the errors
// of bvh_shapes.h and bvh_nearest.h. The call has then changed nothing. A
// failed allocation throws std::bad_alloc. All bodies, their bounds, masks and
// pairs are then as before.
//
// Memory: boxes in 3 dimensions take about 5 KB, 46 bytes per id, 24 of them
// the bound, and 33 to 37 bytes per body in the tree (many thousand bodies; 38
// of 1000). With a margin of 0, they take another byte per id for each tree
// that was in memory at the same time, usually 2 bytes. Up to half of the
// places in the tree can be empty after erasures.
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

  // Ids are the caller's numbers below `max_ids`, such as the index of a body.
  // Allocates what is needed per id. Can neither be copied nor moved.
  explicit BroadPhase(std::size_t max_ids,
                      const BroadPhaseOptions& options = {})
      : core_(detail::BvhTypeOf<View>(), max_ids, options) {}

  // Adds bodies. `masks` is empty, or has an element for each id.
  //
  // Up to 256 new bodies wait in a list, which each query tests, until the next
  // Update(). An Insert() that has no room in the list puts all of them into
  // the tree at once: it copies the tree. Insert many bodies by one call.
  void Insert(Span<const std::uint32_t> ids, Span<const Bound> bounds,
              Span<const BodyMasks> masks = {}) {
    core_.Insert(ids, detail::ValuesOfAll(bounds), masks);
  }
  void Insert(std::uint32_t id, const Bound& bound,
              const BodyMasks& masks = {}) {
    Insert({&id, 1}, {&bound, 1}, {&masks, 1});
  }

  // Removes bodies. An id that is given twice is removed once. Their places in
  // the tree become free at one of the next calls of Update(). Until the next
  // UpdatePairs(), a new body under the id of an erased one continues its
  // pairs. Allocates nothing.
  void Erase(Span<const std::uint32_t> ids) { core_.Erase(ids); }
  void Erase(std::uint32_t id) { Erase({&id, 1}); }

  // Changes the bounds of bodies. If an id is given twice, the last bound wins.
  // If a new bound is not inside the body's larger bound, the larger bound and
  // its nodes grow in place. Allocates nothing and takes no lock.
  void Move(Span<const std::uint32_t> ids, Span<const Bound> bounds) {
    core_.Move(ids, detail::ValuesOfAll(bounds));
  }
  void Move(std::uint32_t id, const Bound& bound) {
    Move({&id, 1}, {&bound, 1});
  }

  // Changes the masks of bodies. The next UpdatePairs() looks at all their
  // pairs. Call it, with the same masks, if the result of PairFilter::keep
  // changes for a body. Allocates nothing and takes no lock.
  void SetMasks(Span<const std::uint32_t> ids, Span<const BodyMasks> masks) {
    core_.SetMasks(ids, masks);
  }
  void SetMasks(std::uint32_t id, const BodyMasks& masks) {
    SetMasks({&id, 1}, {&masks, 1});
  }

  // Call it once per frame. Puts new bodies into the tree, removes those that
  // were erased, shrinks the larger bounds that Move() made grow, and sorts
  // bodies again where the order has decayed. Changes no answer. Reads a byte
  // per id, up to the greatest that was in use. Copies the tree if there is
  // something to do. It can delay the work to one of the next 7 calls if there
  // are no new bodies, and at most max(64, size() / 16) bodies left their
  // bounds or were erased.
  void Update(const UpdateOptions& options = {}) { core_.Update(options); }

  // Update() that sorts all bodies.
  void Rebuild(const Runner& run = {}) { core_.Rebuild(run); }

  std::size_t max_ids() const { return core_.max_ids(); }
  std::size_t size() const { return core_.size(); }
  bool empty() const { return size() == 0; }

  // Whether a body has this id, which may be any number.
  bool Has(std::uint32_t id) const { return core_.Has(id); }

  Bound Get(std::uint32_t id) const {
    detail::PlaneValues<Bound> values;
    core_.Get(id, values);
    return detail::BoundOf<Bound>(values);
  }
  BodyMasks MasksOf(std::uint32_t id) const { return core_.MasksOf(id); }

  // Returns a bound that encloses all bodies. It is larger than theirs by up to
  // four times the margin, and encloses where bodies were since Update() last
  // made their bounds tight. An infinite plane stands for a NaN. O(1) plus the
  // new bodies.
  Bound Bounds() const {
    detail::PlaneValues<Bound> values;
    core_.Bounds(values);
    return detail::BoundOf<Bound>(values);
  }

  // Returns whether the tree encloses every body, and has each body once. For
  // tests and bug reports. Must not run beside Move(). O(n).
  [[nodiscard]] bool Validate() const { return core_.Validate(); }

  BroadPhaseStatistics Statistics() const { return core_.Statistics(); }

  // Calls function(std::uint32_t id, const Bound&) for each body that survives
  // the query, which is a bound or a shape of bvh_shapes.h. The function gets
  // the body's own bound, and returns nothing or a Visit (visit.h). The order
  // is unspecified, but the same after the same history.
  //
  // The rest also holds for casts and ForEachPairOf(). A query takes no lock.
  // It tests each body by a bound that the body had during the query: if the
  // tree stores a larger bound, by the body's own. If that bound is being
  // written, the query waits until it is written. A Move() that returned before
  // the query began (in the sense of happens-before) is seen. A query can see
  // some moves of one Move() of many bodies, and not yet the others.
  //
  // The function may take locks, run other queries and call Move(), Insert()
  // and the other calls. The query keeps the tree that it began with, so it may
  // still find a body that its function erased or moved away. The tree's memory
  // is freed by the first Update() after the query has ended. The function must
  // return on the thread that called the query: a fiber must not go on on
  // another thread. Exceptions of the function pass through.
  template <typename Function, typename Query = typename View::Query,
            typename Asked = detail::BvhAsked<View, Query>>
  void ForEach(const Query& query, std::uint64_t mask,
               Function&& function) const {
    detail::Callback call{[&function](std::uint32_t id, const float* planes) {
      const auto bound = detail::BoundFrom<Bound, 1>(planes);
      return function(id, bound);
    }};
    core_.ForEach(Asked::Of(query), mask, &decltype(call)::Run, &call);
  }

  // Calls function(std::uint32_t id, float t, const Bound&), or function(id,
  // t), for the bodies that `box` touches on its way to `box` + max_t *
  // `direction`, or that a ray enters. The function returns nothing, a Visit,
  // or a Limit of t (visit.h). With Limit, a negative one ends the cast, and an
  // infinite one changes nothing. Bodies come about near to far, and not
  // sorted. t, limits, NaN and infinities are as in BoxCast() and RayCast()
  // (bvh_nearest.h).
  template <typename Function>
  void ForEachCast(const Aabb<kDimensions>& box,
                   const Point<kDimensions>& direction, float max_t,
                   std::uint64_t mask, Function&& function) const {
    Cast({"BroadPhase::ForEachCast", box.min.data(), box.max.data(),
          direction.data(), max_t, 0.0f},
         mask, function);
  }
  template <typename Function>
  void ForEachCast(const Ray<kDimensions>& ray, std::uint64_t mask,
                   Function&& function) const {
    Cast({"BroadPhase::ForEachCast", ray.origin.data(), ray.origin.data(),
          ray.direction.data(), ray.max_t, 0.0f},
         mask, function);
  }

  // Sphere cast: the same for the bodies that `sphere` touches on its way to
  // its center + max_t * `direction`. t is where its distance from the body's
  // box becomes the radius, and, for an octahedron, its range of D touches the
  // body's (Sphere of bvh_shapes.h). The corners and edges are round, unlike
  // those of RayCast() with a radius.
  //
  // Rounding: t is at most the exact value, and no hit is missed. t is less by
  // at most 2^-18 (relative), or by the error from rounding the center, the
  // radius and the planes to 2^-20 of their magnitudes. A sphere that misses a
  // box by less can hit it.
  //
  // An axis with a NaN or an infinity limits nothing. An inverted bound
  // (min > max) is hit as by RayCast() with the radius.
  template <typename Function>
  void ForEachCast(const Sphere<kDimensions>& sphere,
                   const Point<kDimensions>& direction, float max_t,
                   std::uint64_t mask, Function&& function) const {
    Cast({"BroadPhase::ForEachCast", sphere.center.data(), sphere.center.data(),
          direction.data(), max_t, sphere.radius},
         mask, function);
  }

  // Calls function(std::uint32_t a, std::uint32_t b) for the pairs of a body of
  // the set, which is `a`, and any other body, if the masks and the filter keep
  // them. The function returns nothing or a Visit. A pair of two bodies of the
  // set is found once, in either order. An id may be given twice.
  //
  // Two bodies are a pair if their bounds are at most `margin` apart on each of
  // X, Y and Z, and kDimensions * `margin` on D, without rounding. Must be
  // finite and not negative. The cost grows with the set. Can allocate memory
  // for the time of the call (PairsOf() of bvh_pairs.h).
  template <typename Function>
  void ForEachPairOf(Span<const std::uint32_t> ids, float margin,
                     Function&& function) const {
    detail::Callback call{function};
    core_.ForEachPairOf(PairKernels(), ids, nullptr, margin,
                        &decltype(call)::Run, &call);
  }

  // The same with masks of the call instead of the rule of BodyMasks:
  // `masks[i]` finds a body if its category has a bit of it. All ones find
  // every body. If both bodies of a pair are in the set, the mask of either is
  // enough. PairFilter::keep gets the result as `masks_match`.
  template <typename Function>
  void ForEachPairOf(Span<const std::uint32_t> ids,
                     Span<const std::uint64_t> masks, float margin,
                     Function&& function) const {
    detail::Callback call{function};
    core_.ForEachPairOf(PairKernels(), ids, &masks, margin,
                        &decltype(call)::Run, &call);
  }

  // Finds all pairs of bodies whose bounds overlap and that the masks and the
  // filter keep. Calls ended(a, b) for each pair that was one after the last
  // UpdatePairs() and is none now, then began(a, b) for each new one. The
  // functions return nothing. Does not need Update() before it. a < b,
  // and each of the two lists is sorted by a, then by b. A pair of bodies that
  // were erased ends. A body that was erased and inserted again under its id is
  // the same body.
  //
  // The cost grows with the bodies that changed since the last call, and a
  // little with the number of pairs. The pairs of larger bounds that overlap
  // are kept, in 8 to 16 bytes each, and in several times that during the call.
  // If a body moved inside its larger bound, only its kept pairs are tested. A
  // body that moves during the call counts as changed in the next call too.
  //
  // The functions run without a lock, after the pairs were stored, so they may
  // change the broad phase. If one of them throws, the remaining events of this
  // call are lost.
  //
  // `run` (runner.h) runs up to 16 parts of the work, if many bodies changed or
  // there are many pairs. The events do not depend on it. If it throws, all
  // pairs are as before.
  template <typename Began, typename Ended>
  void UpdatePairs(Began&& began, Ended&& ended, const Runner& run = {}) {
    static_assert(
        std::is_void_v<decltype(began(std::uint32_t{}, std::uint32_t{}))> &&
            std::is_void_v<decltype(ended(std::uint32_t{}, std::uint32_t{}))>,
        "the functions of UpdatePairs() must return void");
    struct Both {
      Began& began;
      Ended& ended;
    } both{began, ended};
    core_.UpdatePairs(PairKernels(),
                      {[](void* context, std::uint32_t a, std::uint32_t b) {
                         static_cast<Both*>(context)->began(a, b);
                       },
                       [](void* context, std::uint32_t a, std::uint32_t b) {
                         static_cast<Both*>(context)->ended(a, b);
                       },
                       &both},
                      run);
  }

 private:
  static const detail::BvhPairKernels* PairKernels() {
    return detail::BvhPairKernelsOf<Bound::kAxes>::kTargets;
  }
  template <typename Function>
  void Cast(const detail::LineCast& cast, std::uint64_t mask,
            Function& function) const {
    detail::Callback call{detail::WithPlanes<Bound, 1>(function)};
    core_.ForEachCast(cast, mask, &decltype(call)::Run, &call);
  }

  detail::BroadPhaseCore core_;
};

using AabbBroadPhase2 = BroadPhase<AabbView2>;
using AabbBroadPhase3 = BroadPhase<AabbView3>;
using AaboBroadPhase2 = BroadPhase<AaboView2>;
using AaboBroadPhase3 = BroadPhase<AaboView3>;

}  // namespace halfspace

#endif  // HALFSPACE_BROAD_PHASE_H_
