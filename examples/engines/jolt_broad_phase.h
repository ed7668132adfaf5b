// Jolt's broad phase on halfspace::AabbBroadPhase3, for Jolt 5.5.
//
// Copy this file and active_pairs.h, link halfspace into Jolt, and change two
// lines of Jolt/Physics/PhysicsSystem.cpp:
//
//   #include <jolt_broad_phase.h>  // not ...BroadPhase/BroadPhaseQuadTree.h
//   #define BROAD_PHASE BroadPhaseHalfspace
//
// jolt.cmake does that to a copy, and builds Jolt's unit tests.
//
// - Jolt calls AddBodies, RemoveBodies and NotifyBodiesLayerChanged under locks
//   of bodies, for which the function of a query can wait. Insert(), Erase()
//   and SetMasks() wait for queries. So these changes are queued, and applied
//   by the next FrameSync(), or by the next query outside a step.
// - Moves are never queued, except those of a body that is to be inserted.
// - A query outside a step finds all bodies that were added before it, and no
//   query reports a body that was removed before it.
// - Functions of queries may lock bodies and run other queries. As with Jolt's
//   own broad phase, a thread must not query while it holds a lock of a body.
// - There are at most 32 broad phase layers.
#ifndef HALFSPACE_EXAMPLES_ENGINES_JOLT_BROAD_PHASE_H_
#define HALFSPACE_EXAMPLES_ENGINES_JOLT_BROAD_PHASE_H_

#include <Jolt/Geometry/OrientedBox.h>
#include <Jolt/Physics/Body/BodyManager.h>
#include <Jolt/Physics/Body/BodyPair.h>
#include <Jolt/Physics/Collision/AABoxCast.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhase.h>
#include <Jolt/Physics/Collision/CastResult.h>
#include <Jolt/Physics/Collision/RayCast.h>
#include <halfspace/broad_phase.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "active_pairs.h"

namespace JPH {

class BroadPhaseHalfspace final : public BroadPhase {
  using Id = std::uint32_t;
  using Ids = halfspace::Span<const Id>;
  using Box = halfspace::Aabb3;
  using LayerFilter = BroadPhaseLayerFilter;

  // The function of a cast.
  template <typename Collector>
  auto OnHit(Collector& hits, const ObjectLayerFilter& objects) const {
    return [&](Id id, float fraction) {
      const InFunction in_function;
      const BodyID body = Wanted(id, objects);
      if (!body.IsInvalid()) hits.AddHit({body, fraction});
      return halfspace::Limit{hits.ShouldEarlyOut()
                                  ? -1
                                  : std::max(0.0f, hits.GetEarlyOutFraction())};
    };
  }

 public:
  JPH_OVERRIDE_NEW_DELETE

  void Init(BodyManager* bodies,
            const BroadPhaseLayerInterface& layers) override {
    BroadPhase::Init(bodies, layers);
    layers_ = layers.GetNumBroadPhaseLayers();
    JPH_ASSERT(layers_ <= 32);
    states_ = std::make_unique<State[]>(bodies->GetMaxBodies());
  }

  void Optimize() override {
    Apply();
    bodies_.Rebuild();
  }

  // The last call before a step in which no body is locked. So it may wait for
  // queries whose functions lock bodies.
  void FrameSync() override {
    Apply();
    bodies_.Update();
  }

  // The step between these two holds the locks of all bodies.
  void LockModifications() override { in_step_ = true; }
  void UnlockModifications() override { in_step_ = false; }

  // Jolt has found the pairs of a step. Bodies move between here and the next.
  void UpdateFinalize(const UpdateState&) override { has_pairs_ = false; }

  void AddBodiesFinalize(BodyID* ids, int number, AddState) override {
    for (int i = 0; i < number; ++i) At(ids[i]).SetInBroadPhaseInternal(true);
    Queue(Change::kInsert, ids, number);
  }

  void RemoveBodies(BodyID* ids, int number) override {
    for (int i = 0; i < number; ++i) At(ids[i]).SetInBroadPhaseInternal(false);
    Queue(Change::kErase, ids, number);
  }

  void NotifyBodiesLayerChanged(BodyID* ids, int number) override {
    Queue(Change::kSetMasks, ids, number);
    NotifyBodiesAABBChanged(ids, number, true);
  }

  void NotifyBodiesAABBChanged(BodyID* ids, int number, bool) override {
    thread_local std::vector<Id> moved;
    thread_local std::vector<Box> bounds;
    moved.clear();
    bounds.clear();
    for (int i = 0; i < number; ++i) {
      const Id id = ids[i].GetIndex();
      if (states_[id].queued.load(std::memory_order_acquire) > 0) {
        Queue(Change::kMove, &ids[i], 1);
        continue;
      }
      moved.push_back(id);
      bounds.push_back(BoxOf(At(ids[i]).GetWorldSpaceBounds()));
    }
    bodies_.Move(moved, bounds);
  }

  void CastRay(const RayCast& ray, RayCastBodyCollector& hits,
               const LayerFilter& layers,
               const ObjectLayerFilter& objects) const override {
    Apply();
    const float limit = std::clamp(hits.GetEarlyOutFraction(), 0.0f, 1.0f);
    const halfspace::Ray3 line = {PointOf(ray.mOrigin), PointOf(ray.mDirection),
                                  limit};
    halfspace::RayCast(bodies_, line, OnHit(hits, objects), Search(layers));
  }

  void CastAABox(const AABoxCast& cast, CastShapeBodyCollector& hits,
                 const LayerFilter& layers,
                 const ObjectLayerFilter& objects) const override {
    Apply();
    CastAABoxNoLock(cast, hits, layers, objects);
  }

  void CastAABoxNoLock(const AABoxCast& cast, CastShapeBodyCollector& hits,
                       const LayerFilter& layers,
                       const ObjectLayerFilter& objects) const override {
    const float limit =
        std::clamp(hits.GetPositiveEarlyOutFraction(), 0.0f, 1.0f);
    BoxCast(bodies_, BoxOf(cast.mBox), PointOf(cast.mDirection), limit,
            OnHit(hits, objects), Search(layers));
  }

  void CollideAABox(const AABox& box, CollideShapeBodyCollector& hits,
                    const LayerFilter& layers,
                    const ObjectLayerFilter& objects) const override {
    Collide(BoxOf(box), hits, layers, objects);
  }

  void CollideSphere(Vec3Arg center, float radius,
                     CollideShapeBodyCollector& hits, const LayerFilter& layers,
                     const ObjectLayerFilter& objects) const override {
    Collide(halfspace::Sphere3{PointOf(center), radius}, hits, layers, objects);
  }

  void CollidePoint(Vec3Arg point, CollideShapeBodyCollector& hits,
                    const LayerFilter& layers,
                    const ObjectLayerFilter& objects) const override {
    Collide(PointOf(point), hits, layers, objects);
  }

  void CollideOrientedBox(const OrientedBox& box,
                          CollideShapeBodyCollector& hits,
                          const LayerFilter& layers,
                          const ObjectLayerFilter& objects) const override {
    const Mat44& axes = box.mOrientation;
    Collide(halfspace::OrientedBox3{PointOf(axes.GetTranslation()),
                                    {PointOf(axes.GetAxisX()),
                                     PointOf(axes.GetAxisY()),
                                     PointOf(axes.GetAxisZ())},
                                    PointOf(box.mHalfExtents)},
            hits, layers, objects);
  }

  // Jolt calls it for parts of its list of active bodies, on several threads.
  // The first call of a step finds the pairs of the whole list.
  void FindCollidingPairs(BodyID* active, int number, float distance,
                          const ObjectVsBroadPhaseLayerFilter& layers,
                          const ObjectLayerPairFilter& objects,
                          BodyPairCollector& pairs) const override {
    if (!has_pairs_.load(std::memory_order_acquire)) {
      std::lock_guard lock(pairs_mutex_);
      if (!has_pairs_) FindPairs(distance);
      has_pairs_.store(true, std::memory_order_release);
    }
    for (int i = 0; i < number; ++i) {
      const Body& a = At(active[i]);
      const auto add = [&](Id other) {
        const Body* b = mBodyManager->GetBodies()[other];
        if (BodyManager::sIsValidBodyPointer(b) && b->IsInBroadPhase() &&
            layers.ShouldCollide(a.GetObjectLayer(), b->GetBroadPhaseLayer()) &&
            objects.ShouldCollide(a.GetObjectLayer(), b->GetObjectLayer()) &&
            Body::sFindCollidingPairsCanCollide(a, *b)) {
          pairs.AddHit({a.GetID(), b->GetID()});
        }
      };
      const std::uint32_t place = a.GetIndexInActiveBodiesInternal();
      const Id id = active[i].GetIndex();
      if (pairs_.Has(place)) {
        for (const Id other : pairs_.Of(place)) add(other);
      } else if (bodies_.Has(id)) {  // it woke up in this step
        halfspace::PairOptions options;
        options.margin = distance;
        ForEachPairOf(
            bodies_, Ids(&id, 1),
            [&](halfspace::Span<const halfspace::IdPair> found) {
              for (const auto& [x, y] : found) add(x == id ? y : x);
            },
            options);
      }
    }
  }

  AABox GetBounds() const override {
    Apply();
    const Box all = bodies_.Bounds();
    return AABox(Vec3(all.min[0], all.min[1], all.min[2]),
                 Vec3(all.max[0], all.max[1], all.max[2]));
  }

 private:
  struct Change {
    enum Kind { kInsert, kErase, kSetMasks, kMove } kind;
    Id id;
    Box bound;
    halfspace::BodyMasks masks;
  };

  // What queries report of a body. It changes when a change is queued.
  struct State {
    std::atomic<Id> body_id{BodyID::cInvalidBodyID};
    std::atomic<ObjectLayer> layer{0};
    std::atomic<int> queued{0};  // insertions and moves
  };

  // A thread that runs the function of a query must not change the bodies.
  struct InFunction {
    InFunction() { ++depth; }
    ~InFunction() { --depth; }
    static inline thread_local int depth = 0;
  };

  void Queue(Change::Kind kind, const BodyID* ids, int number) {
    std::lock_guard lock(changes_mutex_);
    for (int i = 0; i < number; ++i) {
      const Body& body = At(ids[i]);
      const Id id = ids[i].GetIndex();
      State& state = states_[id];
      state.body_id = kind == Change::kErase
                          ? BodyID::cInvalidBodyID
                          : ids[i].GetIndexAndSequenceNumber();
      state.layer = body.GetObjectLayer();
      if (kind == Change::kInsert || kind == Change::kMove) ++state.queued;
      changes_.push_back({kind, id, BoxOf(body.GetWorldSpaceBounds()),
                          MasksOf(body.GetBroadPhaseLayer())});
    }
    has_changes_ = true;
  }

  // Makes the changes that wait. The calls of bodies_ wait for queries, so
  // changes_mutex_ is not held around them.
  void Apply() const {
    if (!has_changes_ || in_step_ || InFunction::depth > 0) return;
    std::lock_guard apply(apply_mutex_);
    std::vector<Change> changes;
    {
      std::lock_guard lock(changes_mutex_);
      changes.swap(changes_);
    }
    Make(changes);
    std::lock_guard lock(changes_mutex_);
    has_changes_ = !changes_.empty();
  }

  void Make(const std::vector<Change>& changes) const {
    std::vector<Id> ids;
    std::vector<Box> bounds;
    std::vector<halfspace::BodyMasks> masks;
    for (std::size_t i = 0; i < changes.size();) {
      const Change::Kind kind = changes[i].kind;
      ids.clear();
      bounds.clear();
      masks.clear();
      for (; i < changes.size() && changes[i].kind == kind; ++i) {
        ids.push_back(changes[i].id);
        bounds.push_back(changes[i].bound);
        masks.push_back(changes[i].masks);
      }
      if (kind == Change::kInsert) bodies_.Insert(ids, bounds, masks);
      if (kind == Change::kErase) bodies_.Erase(ids);
      if (kind == Change::kSetMasks) bodies_.SetMasks(ids, masks);
      if (kind == Change::kMove) bodies_.Move(ids, bounds);
      if (kind == Change::kInsert || kind == Change::kMove) {
        for (const Id id : ids) --states_[id].queued;
      }
    }
  }

  void FindPairs(float distance) const {
    constexpr EBodyType kType = EBodyType::RigidBody;
    const BodyID* active = mBodyManager->GetActiveBodiesUnsafe(kType);
    const Id number = mBodyManager->GetNumActiveBodies(kType);
    std::vector<Id> ids;
    for (Id i = 0; i < number && bodies_.Has(active[i].GetIndex()); ++i) {
      ids.push_back(active[i].GetIndex());
    }
    pairs_.Find(bodies_, ids, distance);
  }

  template <typename Query>
  void Collide(const Query& query, CollideShapeBodyCollector& hits,
               const LayerFilter& layers,
               const ObjectLayerFilter& objects) const {
    Apply();
    halfspace::QueryOptions options;
    options.mask = MaskOf(layers);
    ForEachSurvivor(
        bodies_, query,
        [&](Ids ids) {
          const InFunction in_function;
          for (const Id id : ids) {
            const BodyID body = Wanted(id, objects);
            if (!body.IsInvalid()) hits.AddHit(body);
            if (hits.ShouldEarlyOut()) return false;
          }
          return true;
        },
        options);
  }

  static halfspace::BodyMasks MasksOf(BroadPhaseLayer layer) {
    return {std::uint32_t{1} << layer.GetValue()};
  }
  std::uint32_t MaskOf(const LayerFilter& layers) const {
    std::uint32_t mask = 0;
    for (unsigned i = 0; i < layers_; ++i) {
      const BroadPhaseLayer layer(static_cast<BroadPhaseLayer::Type>(i));
      if (layers.ShouldCollide(layer)) mask |= MasksOf(layer).category;
    }
    return mask;
  }
  halfspace::SearchOptions Search(const LayerFilter& layers) const {
    halfspace::SearchOptions options;
    options.mask = MaskOf(layers);
    return options;
  }

  // Returns an invalid id for a body that no query reports.
  BodyID Wanted(Id id, const ObjectLayerFilter& objects) const {
    const BodyID body(states_[id].body_id);
    return objects.ShouldCollide(states_[id].layer) ? body : BodyID();
  }
  Body& At(BodyID id) const {
    return *mBodyManager->GetBodies()[id.GetIndex()];
  }

  static halfspace::Point3 PointOf(Vec3Arg v) {
    return {v.GetX(), v.GetY(), v.GetZ()};
  }
  static Box BoxOf(const AABox& box) {
    return {PointOf(box.mMin), PointOf(box.mMax)};
  }

  // Queries are const, and apply changes.
  mutable halfspace::AabbBroadPhase3 bodies_{
      halfspace::BroadPhaseOptions{.moves_are_seen_at_once = true}};
  mutable std::mutex apply_mutex_;
  mutable std::mutex changes_mutex_;
  mutable std::vector<Change> changes_;
  mutable std::atomic<bool> has_changes_{false};
  std::atomic<bool> in_step_{false};
  unsigned layers_ = 0;
  std::unique_ptr<State[]> states_;  // by id

  // Of a step.
  mutable std::mutex pairs_mutex_;
  mutable ActivePairs pairs_;
  mutable std::atomic<bool> has_pairs_{false};
};

}  // namespace JPH

#endif  // HALFSPACE_EXAMPLES_ENGINES_JOLT_BROAD_PHASE_H_
