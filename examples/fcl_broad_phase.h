// FCL's broad phase on halfspace::BroadPhase.
//
//   FclBroadPhase objects;  // then registerObjects()
//   objects.collide(&data, fcl::DefaultCollisionFunction<double>);
//
// FCL's boxes are of doubles, and ours of floats. Both sides of a comparison
// are rounded by the same function, so boxes that overlap still do. The boxes
// that are found are tested again in doubles. Queries may run on several
// threads. As in FCL's own tree, an object may be deleted before clear() and
// before unregisterObject(), and update() of an object that was never
// registered does nothing.
#ifndef HALFSPACE_EXAMPLES_FCL_BROAD_PHASE_H_
#define HALFSPACE_EXAMPLES_FCL_BROAD_PHASE_H_

#include <fcl/broadphase/broadphase_collision_manager.h>
#include <halfspace/broad_phase.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

class FclBroadPhase : public fcl::BroadPhaseCollisionManagerd {
  using Id = std::uint32_t;
  using Ids = halfspace::Span<const Id>;
  using Box = halfspace::Aabb3;
  using Object = fcl::CollisionObjectd;
  using Objects = std::vector<Object*>;
  using Manager = fcl::BroadPhaseCollisionManagerd;
  using Test = fcl::CollisionCallBack<double>;
  using Near = fcl::DistanceCallBack<double>;

 public:
  void registerObjects(const Objects& objects) override {
    std::vector<Id> ids;
    std::vector<Box> boxes;
    for (Object* object : objects) {
      if (free_.empty()) {
        free_.push_back(static_cast<Id>(objects_.size()));
        objects_.push_back(nullptr);
      }
      if (!ids_.emplace(object, free_.back()).second) continue;
      ids.push_back(free_.back());
      boxes.push_back(BoxOf(object->getAABB()));
      objects_[ids.back()] = object;
      free_.pop_back();
    }
    bodies_.Insert(ids, boxes);  // faster than a call for each
  }
  void registerObject(Object* object) override { registerObjects({object}); }
  void unregisterObject(Object* object) override {
    const auto at = ids_.find(object);
    if (at == ids_.end()) return;
    bodies_.Erase(at->second);
    objects_[at->second] = nullptr;
    free_.push_back(at->second);
    ids_.erase(at);
  }
  void clear() override { *this = FclBroadPhase(); }

  void setup() override { bodies_.Update(); }
  void update() override { Move(AllIds()); }
  void update(Object* object) override { update(Objects{object}); }
  void update(const Objects& objects) override {
    std::vector<Id> ids;
    for (Object* object : objects) {
      const auto at = ids_.find(object);
      if (at != ids_.end()) ids.push_back(at->second);
    }
    Move(ids);
  }
  bool empty() const override { return ids_.empty(); }
  std::size_t size() const override { return ids_.size(); }
  void getObjects(Objects& objects) const override {
    objects.clear();
    for (const Id id : AllIds()) objects.push_back(objects_[id]);
  }

  void collide(Object* object, void* data, Test test) const override {
    CollideAll({object}, data, test);
  }
  void collide(void* data, Test test) const override {
    ForEachPairOf(bodies_, AllIds(), [&](const auto& pairs) {
      return !std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
        return Stops(objects_[pair.a], objects_[pair.b], data, test);
      });
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
    if (other == this) return distance(data, near);
    Objects others;
    other->getObjects(others);
    Nearest(others, false, data, near);
  }

 private:
  static Box BoxOf(const fcl::AABBd& box) {
    const fcl::Vector3<float> low = box.min_.cast<float>();
    const fcl::Vector3<float> high = box.max_.cast<float>();
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }
  void Move(Ids ids) {
    std::vector<Box> boxes;
    for (const Id id : ids) boxes.push_back(BoxOf(objects_[id]->getAABB()));
    bodies_.Move(ids, boxes);
    bodies_.Update();
  }
  std::vector<Id> AllIds() const {
    std::vector<Id> ids;
    for (Id id = 0; id < objects_.size(); ++id) {
      if (objects_[id] != nullptr) ids.push_back(id);
    }
    return ids;
  }
  static bool Stops(Object* a, Object* b, void* data, Test test) {
    return a->getAABB().overlap(b->getAABB()) && test(a, b, data);
  }
  void CollideAll(const Objects& others, void* data, Test test) const {
    bool stops = false;
    for (std::size_t i = 0; i < others.size() && !stops; ++i) {
      ForEachSurvivor(bodies_, BoxOf(others[i]->getAABB()), [&](Ids ids) {
        stops = std::any_of(ids.begin(), ids.end(), [&](Id id) {
          return Stops(objects_[id], others[i], data, test);
        });
        return !stops;
      });
    }
  }

  // By boxes that grow, until no object can be nearer than `least`. If `others`
  // are our own objects by id, each is tested with those of greater ids.
  void Nearest(const Objects& others, bool own, void* data, Near near) const {
    double least = std::numeric_limits<double>::max();
    bool stop = false;
    std::size_t left = size();
    for (Id i = 0; i < others.size(); ++i) {
      if (others[i] == nullptr) continue;
      if (own) --left;
      const fcl::AABBd& from = others[i]->getAABB();
      double begin = -1, end = 0;
      for (std::size_t n = 0; n < left && begin < least && !stop; begin = end) {
        end = std::min(2 * end + from.radius() + 1e-3, least);
        const fcl::AABBd box(from, fcl::Vector3d::Constant(1.000001 * end));
        ForEachSurvivor(bodies_, BoxOf(box), [&](Ids ids) {
          for (const Id id : ids) {
            const double at = from.distance(objects_[id]->getAABB());
            if ((own && id <= i) || at <= begin || at > end) continue;
            ++n;
            stop = at < least && near(objects_[id], others[i], data, least);
            if (stop) return false;
          }
          return true;
        });
      }
    }
  }

  halfspace::AabbBroadPhase3 bodies_;
  Objects objects_;  // by id, null if an id is free
  std::vector<Id> free_;
  std::unordered_map<Object*, Id> ids_;
};

#endif  // HALFSPACE_EXAMPLES_FCL_BROAD_PHASE_H_
