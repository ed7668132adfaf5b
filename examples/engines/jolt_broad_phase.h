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
// - A query finds all bodies that were added before it, where they are now, and
//   none that was removed before it.
// - Jolt adds and removes bodies under locks of bodies, for which the function
//   of a query can wait. No change waits for the function of a query.
// - Functions of queries may lock bodies and run other queries.
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

  void Optimize() override { bodies_.Rebuild(); }
  void FrameSync() override { bodies_.Update(); }

  // Jolt has found the pairs of a step. Bodies move between here and the next.
  void UpdateFinalize(const UpdateState&) override { has_pairs_ = false; }

  void AddBodiesFinalize(BodyID* ids, int number, AddState) override {
    for (int i = 0; i < number; ++i) {
      Report(ids[i], ids[i].GetIndexAndSequenceNumber());
      At(ids[i]).SetInBroadPhaseInternal(true);
    }
    const List& list = ListOf(ids, number);
    bodies_.Insert(list.ids, list.bounds, list.masks);
  }

  void RemoveBodies(BodyID* ids, int number) override {
    for (int i = 0; i < number; ++i) {
      Report(ids[i], BodyID::cInvalidBodyID);
      At(ids[i]).SetInBroadPhaseInternal(false);
    }
    bodies_.Erase(ListOf(ids, number).ids);
  }

  void NotifyBodiesLayerChanged(BodyID* ids, int number) override {
    for (int i = 0; i < number; ++i) {
      Report(ids[i], ids[i].GetIndexAndSequenceNumber());
    }
    const List& list = ListOf(ids, number);
    bodies_.SetMasks(list.ids, list.masks);
    bodies_.Move(list.ids, list.bounds);
  }

  void NotifyBodiesAABBChanged(BodyID* ids, int number, bool) override {
    const List& list = ListOf(ids, number);
    bodies_.Move(list.ids, list.bounds);
  }

  void CastRay(const RayCast& ray, RayCastBodyCollector& hits,
               const LayerFilter& layers,
               const ObjectLayerFilter& objects) const override {
    const float limit = std::clamp(hits.GetEarlyOutFraction(), 0.0f, 1.0f);
    const halfspace::Ray3 line = {PointOf(ray.mOrigin), PointOf(ray.mDirection),
                                  limit};
    halfspace::RayCast(bodies_, line, OnHit(hits, objects), Search(layers));
  }

  void CastAABox(const AABoxCast& cast, CastShapeBodyCollector& hits,
                 const LayerFilter& layers,
                 const ObjectLayerFilter& objects) const override {
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
    const Box all = bodies_.Bounds();
    return AABox(Vec3(all.min[0], all.min[1], all.min[2]),
                 Vec3(all.max[0], all.max[1], all.max[2]));
  }

 private:
  // What queries report of a body.
  struct State {
    std::atomic<Id> body_id{BodyID::cInvalidBodyID};
    std::atomic<ObjectLayer> layer{0};
  };
  void Report(const BodyID& id, Id body_id) {
    State& state = states_[id.GetIndex()];
    state.body_id = body_id;
    state.layer = At(id).GetObjectLayer();
  }

  struct List {
    std::vector<Id> ids;
    std::vector<Box> bounds;
    std::vector<halfspace::BodyMasks> masks;
  };
  // The list is that of the calling thread, until its next call.
  const List& ListOf(const BodyID* ids, int number) const {
    thread_local List list;
    list.ids.clear();
    list.bounds.clear();
    list.masks.clear();
    for (int i = 0; i < number; ++i) {
      const Body& body = At(ids[i]);
      list.ids.push_back(ids[i].GetIndex());
      list.bounds.push_back(BoxOf(body.GetWorldSpaceBounds()));
      list.masks.push_back(MasksOf(body.GetBroadPhaseLayer()));
    }
    return list;
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
    halfspace::QueryOptions options;
    options.mask = MaskOf(layers);
    ForEachSurvivor(
        bodies_, query,
        [&](Ids ids) {
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

  halfspace::AabbBroadPhase3 bodies_{
      halfspace::BroadPhaseOptions{.moves_are_seen_at_once = true}};
  unsigned layers_ = 0;
  std::unique_ptr<State[]> states_;  // by id

  // The pairs of a step.
  mutable std::mutex pairs_mutex_;
  mutable ActivePairs pairs_;
  mutable std::atomic<bool> has_pairs_{false};
};

}  // namespace JPH

#endif  // HALFSPACE_EXAMPLES_ENGINES_JOLT_BROAD_PHASE_H_
