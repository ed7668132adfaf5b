// FCL's queries on halfspace's broad phase (fcl_broad_phase.h): collisions and
// distances of boxes, spheres and cylinders that move, among themselves, with
// one other object and with the objects of another manager. FCL's own broad
// phase has the same contacts and the same least distances.
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "fcl_broad_phase.h"

namespace {

constexpr int kFrames = 20;
constexpr int kObjects = 400;

using Manager = fcl::BroadPhaseCollisionManagerd;
using Object = fcl::CollisionObjectd;

// Objects on a disk around (x, 0, 0), which turns.
class Scene {
 public:
  Scene(int count, double x, double spacing) : x_(x), spacing_(spacing) {
    const std::array<std::shared_ptr<fcl::CollisionGeometryd>, 3> shapes = {
        std::make_shared<fcl::Boxd>(1, 0.6, 0.8),
        std::make_shared<fcl::Sphered>(0.5),
        std::make_shared<fcl::Cylinderd>(0.3, 1)};
    for (int i = 0; i < count; ++i) {
      objects_.push_back(
          std::make_unique<Object>(shapes[static_cast<std::size_t>(i) % 3]));
    }
    MoveTo(0);
  }

  void MoveTo(int frame) {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const auto n = static_cast<double>(i);
      const double angle = 0.1 * frame + n;
      const double radius = spacing_ * std::sqrt(n);
      objects_[i]->setTransform(
          fcl::AngleAxisd(angle, fcl::Vector3d(1, n, 2).normalized())
              .toRotationMatrix(),
          fcl::Vector3d(radius * std::cos(angle) + x_, radius * std::sin(angle),
                        3 * std::sin(n + 0.05 * frame)));
      objects_[i]->computeAABB();
    }
  }

  std::vector<Object*> Objects() const {
    std::vector<Object*> list;
    for (const auto& object : objects_) list.push_back(object.get());
    return list;
  }

 private:
  double x_;
  double spacing_;
  std::vector<std::unique_ptr<Object>> objects_;
};

// Two objects and the point, normal and depth of each contact of two of them.
struct Contacts {
  std::vector<std::pair<std::pair<Object*, Object*>, std::array<double, 7>>>
      list;

  friend bool operator==(const Contacts& a, const Contacts& b) {
    return a.list == b.list;
  }
};

// FCL's tree passes two objects in any order, so this makes the order the same.
bool OnPair(Object* a, Object* b, void* data) {
  if (b < a) std::swap(a, b);
  fcl::CollisionRequestd request;
  request.enable_contact = true;
  request.num_max_contacts = 8;
  fcl::CollisionResultd result;
  fcl::collide(a, b, request, result);
  for (std::size_t i = 0; i < result.numContacts(); ++i) {
    const fcl::Contactd& c = result.getContact(i);
    static_cast<Contacts*>(data)->list.push_back(
        {{a, b},
         {c.pos[0], c.pos[1], c.pos[2], c.normal[0], c.normal[1], c.normal[2],
          c.penetration_depth}});
  }
  return false;
}

// `data` is the least distance. It is 0 for objects that touch.
bool OnNear(Object* a, Object* b, void* data, double& least) {
  if (b < a) std::swap(a, b);
  fcl::DistanceResultd result;
  fcl::distance(a, b, fcl::DistanceRequestd(), result);
  least = std::min(least, std::max(result.min_distance, 0.0));
  *static_cast<double*>(data) = least;
  return least == 0;
}

template <typename... With>
Contacts ContactsOf(const Manager& manager, With... with) {
  Contacts contacts;
  manager.collide(with..., &contacts, OnPair);
  std::sort(contacts.list.begin(), contacts.list.end());
  return contacts;
}
template <typename... With>
double DistanceOf(const Manager& manager, With... with) {
  double least = -1;
  manager.distance(with..., &least, OnNear);
  return least;
}

// As FCL's own tree, reads no object but the one that a call is given: objects
// may be deleted before unregisterObject() and clear().
bool IsSameWithoutObjects() {
  FclBroadPhase ours;
  fcl::DynamicAABBTreeCollisionManagerd theirs;
  const Scene stays(40, 0, 0.4);
  Object stranger(std::make_shared<fcl::Sphered>(1));
  stranger.computeAABB();
  bool is_same = true;
  for (Manager* manager : std::array<Manager*, 2>{&ours, &theirs}) {
    auto first = std::make_unique<Scene>(30, 2, 0.4);
    auto second = std::make_unique<Scene>(30, 4, 0.4);
    const std::vector<Object*> erased = first->Objects();
    manager->registerObjects(erased);
    manager->registerObjects(second->Objects());
    first.reset();
    for (Object* object : erased) manager->unregisterObject(object);
    manager->update(&stranger);  // was never registered
    is_same = is_same && manager->size() == 30;
    second.reset();
    manager->clear();
    is_same = is_same && manager->empty();
    manager->registerObjects(stays.Objects());
    for (std::size_t i = 0; i < 10; ++i) {  // ids are used again
      manager->unregisterObject(stays.Objects()[3 * i]);
      manager->registerObject(stays.Objects()[3 * i]);
    }
    manager->setup();
  }
  return is_same && ours.size() == theirs.size() &&
         ContactsOf(ours) == ContactsOf(theirs) &&
         DistanceOf(ours) == DistanceOf(theirs);
}

}  // namespace

int main() {
  if (!IsSameWithoutObjects()) {
    std::puts("objects that leave are not as in FCL's own broad phase");
    return 1;
  }

  FclBroadPhase ours, our_robot, our_far;
  fcl::DynamicAABBTreeCollisionManagerd theirs, their_robot, their_far;
  Scene scene(kObjects, 0, 0.5), robot(20, 6, 0.5), far(50, 40, 2);

  Object probe(std::make_shared<fcl::Sphered>(0.7));

  const auto fill = [&](Manager& all, Manager& arm, Manager& other) {
    all.registerObjects(scene.Objects());
    arm.registerObjects(robot.Objects());
    other.registerObjects(far.Objects());
    for (Manager* manager : {&all, &arm, &other}) manager->setup();
  };
  fill(ours, our_robot, our_far);
  fill(theirs, their_robot, their_far);

  std::size_t contacts = 0;
  for (int frame = 1; frame <= kFrames; ++frame) {
    scene.MoveTo(frame);
    robot.MoveTo(-frame);
    probe.setTranslation(fcl::Vector3d(frame - 10, 3, 0.1 * frame));
    probe.computeAABB();
    far.MoveTo(frame);
    for (Manager* manager : std::array<Manager*, 6>{
             &ours, &our_robot, &our_far, &theirs, &their_robot, &their_far}) {
      // One by one, in a list, or all that it has.
      std::vector<Object*> objects;
      manager->getObjects(objects);
      if (frame % 3 == 0) {
        for (Object* object : objects) manager->update(object);
      } else if (frame % 3 == 1) {
        manager->update(objects);
      } else {
        manager->update();
      }
    }
    // An object leaves, and comes back five frames later.
    Object* const guest = scene.Objects()[17];
    if (frame % 10 == 3) {
      ours.unregisterObject(guest);
      theirs.unregisterObject(guest);
    } else if (frame % 10 == 8) {
      ours.registerObject(guest);
      theirs.registerObject(guest);
    }

    const Contacts among = ContactsOf(ours);
    const Contacts with_probe = ContactsOf(ours, &probe);
    const Contacts with_robot = ContactsOf(ours, &our_robot);
    const bool is_same =
        ours.size() == theirs.size() && among == ContactsOf(theirs) &&
        with_probe == ContactsOf(theirs, &probe) &&
        with_robot == ContactsOf(theirs, &their_robot) &&
        DistanceOf(ours) == DistanceOf(theirs) &&
        DistanceOf(our_far, &probe) == DistanceOf(their_far, &probe) &&
        DistanceOf(our_far) == DistanceOf(their_far) &&
        DistanceOf(our_robot, &our_far) == DistanceOf(their_robot, &their_far);
    if (!is_same) {
      std::printf("frame %d differs from FCL's own broad phase\n", frame);
      return 1;
    }
    contacts +=
        among.list.size() + with_probe.list.size() + with_robot.list.size();
  }
  our_robot.clear();
  if (!our_robot.empty() || !ContactsOf(our_robot, &ours).list.empty()) {
    return 1;
  }
  our_robot.registerObjects(robot.Objects());
  std::printf("%d frames: the same %zu contacts and the same distances\n",
              kFrames, contacts);
  std::printf("the last distances are %g, %g and %g\n", DistanceOf(our_far),
              DistanceOf(our_far, &probe), DistanceOf(our_robot, &our_far));
  return contacts > 0 ? 0 : 1;
}
