// Bullet's broad phase on halfspace::BroadPhase.
//
//   BulletBroadPhase broad_phase;
//   btDiscreteDynamicsWorld world(&dispatcher, &broad_phase, &solver, &config);
//
// The hashed pair cache has the pairs whose boxes overlap and that its filter
// keeps. Ray tests and box queries may run on several threads at the same time,
// and so may setAabb() of different bodies.
#ifndef HALFSPACE_EXAMPLES_BULLET_BROAD_PHASE_H_
#define HALFSPACE_EXAMPLES_BULLET_BROAD_PHASE_H_

#include <btBulletCollisionCommon.h>
#include <halfspace/broad_phase.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

class BulletBroadPhase : public btBroadphaseInterface {
  using Id = std::uint32_t;
  using Box = halfspace::Aabb3;
  struct Proxy : btBroadphaseProxy {
    using btBroadphaseProxy::btBroadphaseProxy;
    Id id = 0;
  };

 public:
  BulletBroadPhase() { BulletBroadPhase::resetPool(nullptr); }
  BulletBroadPhase(const BulletBroadPhase&) = delete;
  BulletBroadPhase& operator=(const BulletBroadPhase&) = delete;

  btBroadphaseProxy* createProxy(const btVector3& min, const btVector3& max,
                                 int, void* client, int group, int mask,
                                 btDispatcher*) override {
    auto proxy = std::make_unique<Proxy>(min, max, client, group, mask);
    if (free_.empty()) {
      free_.push_back(static_cast<Id>(proxies_.size()));
      proxies_.emplace_back();
    }
    proxy->id = free_.back();
    // As Bullet counts, so the two bodies of a pair have the same order.
    proxy->m_uniqueId = ++last_unique_id_;
    bodies_.Insert(proxy->id, BoxOf(min, max));
    free_.pop_back();
    return (proxies_[proxy->id] = std::move(proxy)).get();
  }

  void destroyProxy(btBroadphaseProxy* proxy,
                    btDispatcher* dispatcher) override {
    const Id id = IdOf(proxy);
    pairs_.removeOverlappingPairsContainingProxy(proxy, dispatcher);
    bodies_.Erase(id);
    proxies_[id] = nullptr;
    // A new body under this id would inherit pairs that have not ended yet.
    erased_.push_back(id);
  }

  void setAabb(btBroadphaseProxy* proxy, const btVector3& min,
               const btVector3& max, btDispatcher*) override {
    proxy->m_aabbMin = min;
    proxy->m_aabbMax = max;
    bodies_.Move(IdOf(proxy), BoxOf(min, max));
  }

  void getAabb(btBroadphaseProxy* proxy, btVector3& min,
               btVector3& max) const override {
    min = proxy->m_aabbMin;
    max = proxy->m_aabbMax;
  }

  // `min` and `max` are the box of a swept shape around the origin. Bodies come
  // about near to far.
  void rayTest(const btVector3& from, const btVector3& to,
               btBroadphaseRayCallback& callback, const btVector3& min,
               const btVector3& max) override {
    const btVector3 way = to - from;
    BoxCast(bodies_, BoxOf(from + min, from + max), {way.x(), way.y(), way.z()},
            1.0f, [&](Id id, float) { callback.process(At(id)); });
  }

  void aabbTest(const btVector3& min, const btVector3& max,
                btBroadphaseAabbCallback& callback) override {
    ForEachSurvivor(bodies_, BoxOf(min, max), [&](auto ids) {
      for (const Id id : ids) callback.process(At(id));
    });
  }

  // Bullet calls it once per step, after it has moved all bodies.
  void calculateOverlappingPairs(btDispatcher* dispatcher) override {
    bodies_.Update();
    bodies_.UpdatePairs();
    for (const auto& [a, b] : bodies_.began()) {
      pairs_.addOverlappingPair(At(a), At(b));
    }
    for (const auto& [a, b] : bodies_.ended()) {
      if (!At(a) || !At(b)) continue;  // destroyProxy() has removed the pair
      pairs_.removeOverlappingPair(At(a), At(b), dispatcher);
    }
    free_.insert(free_.end(), erased_.begin(), erased_.end());
    erased_.clear();
  }

  btOverlappingPairCache* getOverlappingPairCache() override { return &pairs_; }
  const btOverlappingPairCache* getOverlappingPairCache() const override {
    return &pairs_;
  }

  void getBroadphaseAabb(btVector3& min, btVector3& max) const override {
    const Box all = bodies_.empty() ? Box{} : bodies_.Bounds();
    min.setValue(all.min[0], all.min[1], all.min[2]);
    max.setValue(all.max[0], all.max[1], all.max[2]);
  }

  void resetPool(btDispatcher*) override {
    if (!bodies_.empty()) return;
    halfspace::BroadPhaseOptions options;
    options.filter = {&Keep, this};
    options.moves_are_seen_at_once = true;  // as in Bullet
    bodies_ = halfspace::AabbBroadPhase3(options);
    proxies_.clear();
    free_.clear();
    erased_.clear();
    last_unique_id_ = 0;
  }

  void printStats() override {
    const halfspace::BroadPhaseStatistics all = bodies_.Statistics();
    std::printf("%zu bodies, %zu pairs, %zu bytes, cost ratio %.2f\n",
                all.bodies, all.pairs, all.bytes, all.cost_ratio);
  }

 private:
  static_assert(sizeof(btScalar) == sizeof(float), "Bullet of floats");
  Proxy* At(Id id) const { return proxies_[id].get(); }
  static Id IdOf(btBroadphaseProxy* p) { return static_cast<Proxy*>(p)->id; }
  static Box BoxOf(const btVector3& min, const btVector3& max) {
    return {{min.x(), min.y(), min.z()}, {max.x(), max.y(), max.z()}};
  }
  static bool Keep(void* context, Id a, Id b, bool) {
    const auto& self = *static_cast<BulletBroadPhase*>(context);
    return self.pairs_.needsBroadphaseCollision(self.At(a), self.At(b));
  }

  halfspace::AabbBroadPhase3 bodies_;
  std::vector<std::unique_ptr<Proxy>> proxies_;  // by id
  std::vector<Id> free_, erased_;
  int last_unique_id_ = 0;
  btHashedOverlappingPairCache pairs_;
};

#endif  // HALFSPACE_EXAMPLES_BULLET_BROAD_PHASE_H_
