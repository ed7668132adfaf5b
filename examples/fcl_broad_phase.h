// FCL's broad phase on halfspace::BroadPhase.
//
//   FclBroadPhase objects(max_objects);  // then registerObjects()
//   objects.collide(&data, fcl::DefaultCollisionFunction<double>);
//
// FCL's boxes are of doubles. Ours are of floats, rounded outward, so what they
// find is tested again in doubles. Queries may run on several threads.
#ifndef HALFSPACE_EXAMPLES_FCL_BROAD_PHASE_H_
#define HALFSPACE_EXAMPLES_FCL_BROAD_PHASE_H_

#include <fcl/broadphase/broadphase_collision_manager.h>
#include <halfspace/broad_phase.h>
#include <halfspace/transform.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <vector>

class FclBroadPhase : public fcl::BroadPhaseCollisionManagerd {
  using Id = std::uint32_t;
  using Box = halfspace::Aabb3;
  using Visit = halfspace::Visit;
  using Object = fcl::CollisionObjectd;
  using Objects = std::vector<Object*>;
  using Manager = fcl::BroadPhaseCollisionManagerd;
  using Test = fcl::CollisionCallBack<double>;
  using Near = fcl::DistanceCallBack<double>;

 public:
  explicit FclBroadPhase(std::size_t max_objects) : bodies_(max_objects) {}
  void registerObjects(const Objects& objects) override {
    std::vector<Id> ids;
    std::vector<Box> boxes;
    for (Object* object : objects) {
      ids.push_back(static_cast<Id>(size() + ids.size()));
      boxes.push_back(BoxOf(object->getAABB()));
    }
    bodies_.Insert(ids, boxes);  // faster than a call for each
    objects_.insert(objects_.end(), objects.begin(), objects.end());
    for (const Id id : ids) ids_[objects_[id]] = id;
  }
  void registerObject(Object* object) override { registerObjects({object}); }
  // Ids have no gaps: the last object gets the id that becomes free.
  void unregisterObject(Object* object) override {
    const Id id = ids_.at(object);
    Object* last = objects_[id] = objects_.back();
    bodies_.Move(id, BoxOf(last->getAABB()));
    bodies_.Erase(ids_[last]);
    ids_[last] = id;
    ids_.erase(object);
    objects_.pop_back();
  }
  void clear() override {
    while (!empty()) unregisterObject(objects_.back());
  }

  void setup() override { bodies_.Update(); }
  void update() override { update(objects_); }
  void update(const Objects& objects) override {
    for (Object* object : objects) update(object);
    bodies_.Update();
  }
  void update(Object* object) override {  // setup() makes the tree tight again
    bodies_.Move(ids_.at(object), BoxOf(object->getAABB()));
  }
  bool empty() const override { return objects_.empty(); }
  std::size_t size() const override { return objects_.size(); }
  void getObjects(Objects& objects) const override { objects = objects_; }

  void collide(Object* object, void* data, Test test) const override {
    CollideAll({object}, data, test);
  }
  void collide(void* data, Test test) const override {
    std::vector<Id> ids(size());
    std::iota(ids.begin(), ids.end(), 0u);
    bodies_.ForEachPairOf(ids, 0, [&](Id a, Id b) {
      return TestBoth(objects_[a], objects_[b], data, test);
    });
  }
  void collide(Manager* other, void* data, Test test) const override {
    if (other == this) return collide(data, test);
    Objects others;
    other->getObjects(others);
    CollideAll(others, data, test);
  }

  void distance(Object* object, void* data, Near near) const override {
    Nearest({object}, false, data, near);
  }
  void distance(void* data, Near near) const override {
    Nearest(objects_, true, data, near);
  }
  void distance(Manager* other, void* data, Near near) const override {
    Objects others;
    other->getObjects(others);
    Nearest(others, other == this, data, near);
  }

 private:
  static Box BoxOf(const fcl::AABBd& box) {
    const auto &low = box.min_, &high = box.max_;
    return halfspace::RoundOutward(halfspace::Aabb<3, double>{
        {low[0], low[1], low[2]}, {high[0], high[1], high[2]}});
  }
  static Visit TestBoth(Object* a, Object* b, void* data, Test test) {
    const bool stop = a->getAABB().overlap(b->getAABB()) && test(a, b, data);
    return stop ? Visit::kStop : Visit::kContinue;
  }
  void CollideAll(const Objects& others, void* data, Test test) const {
    auto visit = Visit::kContinue;
    for (Object* other : others) {
      if (visit == Visit::kStop) return;
      bodies_.ForEach(BoxOf(other->getAABB()), ~0ull, [&](Id id, const Box&) {
        return visit = TestBoth(objects_[id], other, data, test);
      });
    }
  }

  // By boxes that grow, until no object can be nearer than `least`.
  void Nearest(const Objects& others, bool self, void* data, Near near) const {
    double least = std::numeric_limits<double>::max();
    bool stop = false;
    for (Id i = 0; i < others.size(); ++i) {
      const fcl::AABBd& from = others[i]->getAABB();
      const Id first = self ? i + 1 : 0;  // each pair once
      double begin = -1, end = 0;
      for (Id n = first; n < size() && begin < least && !stop; begin = end) {
        end = std::min(2 * end + from.radius() + 1e-3, least);
        const fcl::AABBd box(from, fcl::Vector3d::Constant(1.000001 * end));
        bodies_.ForEach(BoxOf(box), ~0ull, [&](Id id, const Box&) {
          const double at = from.distance(objects_[id]->getAABB());
          if (id < first || at <= begin || at > end) return Visit::kContinue;
          ++n;
          stop = at < least && near(objects_[id], others[i], data, least);
          return stop ? Visit::kStop : Visit::kContinue;
        });
      }
    }
  }

  halfspace::AabbBroadPhase3 bodies_;
  Objects objects_;  // by id
  std::unordered_map<Object*, Id> ids_;
};

#endif  // HALFSPACE_EXAMPLES_FCL_BROAD_PHASE_H_
