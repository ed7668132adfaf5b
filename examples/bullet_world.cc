// A simulation by Bullet on halfspace's broad phase (bullet_broad_phase.h).
// Boxes, spheres and capsules fall on stacks of boxes. A second world does the
// same on Bullet's own broad phase. After each step the positions, velocities
// and contacts of both worlds are equal, bit for bit. So are the answers of ray
// tests, sweeps and box queries.
//
// Bullet's own broad phase keeps a pair for a while after the two boxes have
// separated. Such a pair has no contact, but it can change the order of the
// contacts and the islands, and with them how the solver rounds. So in this
// test both worlds sort their contacts, solve all islands at once, and put no
// body to sleep.
#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "bullet_broad_phase.h"

namespace {

constexpr int kSteps = 200;
constexpr int kStacks = 16;
constexpr int kStackHeight = 6;
constexpr int kFalling = 160;

using Floats = std::vector<float>;

void Append(Floats& list, const btVector3& v) {
  list.insert(list.end(), {v.x(), v.y(), v.z()});
}

// Contacts in the order of the bodies' numbers.
class SortedDispatcher : public btCollisionDispatcher {
 public:
  using btCollisionDispatcher::btCollisionDispatcher;

  void dispatchAllCollisionPairs(btOverlappingPairCache* pairs,
                                 const btDispatcherInfo& info,
                                 btDispatcher* dispatcher) override {
    btCollisionDispatcher::dispatchAllCollisionPairs(pairs, info, dispatcher);
    const auto key = [](const btPersistentManifold* m) {
      return std::pair(m->getBody0()->getUserIndex(),
                       m->getBody1()->getUserIndex());
    };
    m_manifoldsPtr.quickSort(
        [&](const btPersistentManifold* a, const btPersistentManifold* b) {
          return key(a) < key(b);
        });
    for (int i = 0; i < m_manifoldsPtr.size(); ++i) {
      m_manifoldsPtr[i]->m_index1a = i;
    }
  }
};

class World {
 public:
  explicit World(btBroadphaseInterface& broad_phase)
      : broad_phase_(broad_phase),
        world_(&dispatcher_, &broad_phase, &solver_, &configuration_) {
    world_.getSimulationIslandManager()->setSplitIslands(false);
    Add(floor_, 0, {0, -1, 0});
    Add(box_, 0, {0, 0.2f, 3});  // stands in the floor, which is no pair

    for (int i = 0; i < kStacks * kStackHeight; ++i) {
      const auto stack = static_cast<float>(i / kStackHeight);
      const auto height = static_cast<float>(i % kStackHeight);
      Add(box_, 1, {3 * stack - 24, 0.5f + height, 0});
    }
    for (int i = 0; i < kFalling; ++i) AddFalling(i);
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World() {
    while (!bodies_.empty()) Remove(bodies_.size() - 1);
  }

  void Step(int step) {
    if (step % 10 == 9) {  // a body leaves, and another one falls
      Remove(2 + static_cast<std::size_t>(step) % 255);
      AddFalling(step);
    }
    if (step % 10 == 4) {  // a body is replaced by another one at its place
      const std::size_t i = 2 + static_cast<std::size_t>(step) % 255;
      const btVector3 at = bodies_[i]->getWorldTransform().getOrigin();
      Remove(i);
      Add(box_, 1, at);
    }
    world_.stepSimulation(1.0f / 60, 0);
  }

  Floats Motion() const {
    Floats all;
    for (const auto& body : bodies_) {
      const btTransform& transform = body->getWorldTransform();
      Append(all, transform.getOrigin());
      for (int i = 0; i < 3; ++i) Append(all, transform.getBasis()[i]);
      Append(all, body->getLinearVelocity());
      Append(all, body->getAngularVelocity());
    }
    return all;
  }

  // Pairs of two bodies in the cache. Bullet's own broad phase keeps some for
  // a while after their boxes have separated.
  std::vector<std::pair<float, float>> Pairs(bool only_overlapping) {
    std::vector<std::pair<float, float>> all;
    const btBroadphasePairArray& cache =
        broad_phase_.getOverlappingPairCache()->getOverlappingPairArray();
    for (int i = 0; i < cache.size(); ++i) {
      const btBroadphaseProxy& a = *cache[i].m_pProxy0;
      const btBroadphaseProxy& b = *cache[i].m_pProxy1;
      if (!only_overlapping || Overlap(a, b.m_aabbMin, b.m_aabbMax)) {
        all.emplace_back(NumberOf(a), NumberOf(b));
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  // Two bodies, two points and an impulse for each contact.
  using Contact = std::array<float, 9>;
  std::vector<Contact> Contacts() {
    std::vector<Contact> all;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold =
          *dispatcher_.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        const btVector3& a = point.getPositionWorldOnA();
        const btVector3& b = point.getPositionWorldOnB();
        all.push_back({NumberOf(manifold.getBody0()),
                       NumberOf(manifold.getBody1()), a.x(), a.y(), a.z(),
                       b.x(), b.y(), b.z(), point.getAppliedImpulse()});
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  // The bodies along a ray and in a box, and the first that a sphere meets.
  Floats Answers(int step) {
    // A step ends with the motion of the bodies. Bullet's own broad phase has
    // larger boxes, which may still enclose them. Ours are of their last place.
    world_.updateAabbs();
    const float shift = 0.2f * static_cast<float>(step % 100) - 10;
    const btVector3 from(-30, 4, shift / 4);
    const btVector3 to(30, 1, -shift / 4);
    Floats hits;
    btCollisionWorld::AllHitsRayResultCallback ray(from, to);
    // The default reports shapes near the ray as well, even outside their box.
    ray.m_flags = btTriangleRaycastCallback::kF_UseGjkConvexCastRaytest;
    world_.rayTest(from, to, ray);
    for (int i = 0; i < ray.m_collisionObjects.size(); ++i) {
      hits.push_back(NumberOf(ray.m_collisionObjects[i]));
    }
    struct InBox : btBroadphaseAabbCallback {
      Floats found;
      bool process(const btBroadphaseProxy* proxy) override {
        // Bullet's own broad phase keeps larger boxes in its tree.
        if (Overlap(*proxy, min, max)) found.push_back(NumberOf(*proxy));

        return true;
      }
      btVector3 min, max;
    } in_box;
    in_box.min.setValue(shift, 0, -2);
    in_box.max.setValue(shift + 8, 3, 2);
    broad_phase_.aabbTest(in_box.min, in_box.max, in_box);

    // The order is that of the broad phase.
    std::sort(hits.begin(), hits.end());
    std::sort(in_box.found.begin(), in_box.found.end());
    hits.insert(hits.end(), in_box.found.begin(), in_box.found.end());

    btCollisionWorld::ClosestConvexResultCallback sweep(from, to);
    world_.convexSweepTest(&sphere_,
                           btTransform(btQuaternion::getIdentity(), from),
                           btTransform(btQuaternion::getIdentity(), to), sweep);
    hits.push_back(sweep.hasHit() ? NumberOf(sweep.m_hitCollisionObject) : -1);
    hits.push_back(sweep.m_closestHitFraction);
    return hits;
  }

  bool IsInBounds() const {
    btVector3 min, max;
    broad_phase_.getBroadphaseAabb(min, max);
    return std::all_of(bodies_.begin(), bodies_.end(), [&](const auto& body) {
      btVector3 low, high;
      broad_phase_.getAabb(body->getBroadphaseProxy(), low, high);
      low.setMin(min);
      high.setMax(max);
      return low == min && high == max;
    });
  }

 private:
  static float NumberOf(const btCollisionObject* body) {
    return static_cast<float>(body->getUserIndex());
  }
  static float NumberOf(const btBroadphaseProxy& proxy) {
    return NumberOf(static_cast<btCollisionObject*>(proxy.m_clientObject));
  }
  static bool Overlap(const btBroadphaseProxy& proxy, const btVector3& min,
                      const btVector3& max) {
    return TestAabbAgainstAabb2(proxy.m_aabbMin, proxy.m_aabbMax, min, max);
  }

  void Add(btCollisionShape& shape, float mass, const btVector3& at) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape.calculateLocalInertia(mass, inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape,
                                                  inertia);
    info.m_startWorldTransform.setOrigin(at);
    auto body = std::make_unique<btRigidBody>(info);
    body->setUserIndex(next_number_++);
    if (mass > 0) body->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(body.get());
    bodies_.push_back(std::move(body));
  }
  void AddFalling(int i) {
    const std::array<btCollisionShape*, 3> shapes = {&box_, &sphere_,
                                                     &capsule_};
    const auto at = [i](int step, int count) {
      return static_cast<float>(i * step % count);
    };
    Add(*shapes[static_cast<std::size_t>(i) % 3], 2,
        {0.9f * at(17, 50) - 22, 8 + 0.7f * at(7, 30), 0.25f * at(5, 9) - 1});
  }
  void Remove(std::size_t i) {
    world_.removeRigidBody(bodies_[i].get());
    bodies_.erase(std::next(bodies_.begin(), static_cast<std::ptrdiff_t>(i)));
  }

  btBroadphaseInterface& broad_phase_;
  btDefaultCollisionConfiguration configuration_;
  SortedDispatcher dispatcher_{&configuration_};
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  btBoxShape floor_{btVector3(60, 1, 60)};
  btBoxShape box_{btVector3(0.5f, 0.5f, 0.5f)};
  btSphereShape sphere_{0.5f};
  btCapsuleShape capsule_{0.3f, 0.6f};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  int next_number_ = 0;
};

// Runs both worlds, and returns whether they stay the same.
bool IsSame(BulletBroadPhase& broad_phase) {
  btDbvtBroadphase bullets_own;
  World world(broad_phase);
  World expected(bullets_own);
  std::size_t contacts = 0;
  std::size_t answers = 0;
  for (int step = 0; step < kSteps; ++step) {
    world.Step(step);
    expected.Step(step);
    const auto touching = world.Contacts();
    const auto pairs = world.Pairs(false);
    const Floats found = world.Answers(step);
    if (world.Motion() != expected.Motion() || pairs != expected.Pairs(true) ||
        touching != expected.Contacts() || found != expected.Answers(step) ||
        !world.IsInBounds()) {
      std::printf("step %d differs from Bullet's own broad phase\n", step);
      return false;
    }
    contacts += touching.size();
    answers += found.size();
  }
  broad_phase.printStats();
  std::printf("%d steps: the same %zu contacts and %zu answers\n", kSteps,
              contacts, answers);
  return contacts > 0 && answers > 0;
}

}  // namespace

int main() {
  BulletBroadPhase broad_phase;
  for (int run = 0; run < 2; ++run) {
    if (!IsSame(broad_phase)) return 1;
    broad_phase.resetPool(nullptr);  // as a new one
  }
  return 0;
}
