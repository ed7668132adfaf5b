#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>

#include "bench/baselines/body_space.h"

namespace halfspace::bench {
namespace {

// The broad phase reads the box alone.
class FclBody : public fcl::CollisionObject<float> {
 public:
  FclBody(const std::shared_ptr<fcl::CollisionGeometry<float>>& geometry,
          std::uint32_t id)
      : CollisionObject(geometry), id_(id) {}

  void SetBox(const Aabb3& box) {
    aabb.min_ = {box.min[0], box.min[1], box.min[2]};
    aabb.max_ = {box.max[0], box.max[1], box.max[2]};
  }
  static std::uint32_t IdOf(const CollisionObject* object) {
    return static_cast<const FclBody*>(object)->id_;
  }

 private:
  std::uint32_t id_;
};

using Object = fcl::CollisionObject<float>;

class FclSpace : public BodySpace<3> {
 public:
  explicit FclSpace(std::size_t bodies) : BodySpace(bodies) {
    const auto geometry = std::make_shared<fcl::Spheref>(1.0f);
    for (std::size_t i = 0; i < bodies; ++i) {
      bodies_.push_back(
          std::make_unique<FclBody>(geometry, static_cast<std::uint32_t>(i)));
    }
  }

  void Insert(Ids ids, Boxes boxes) override {
    SetBoxes(ids, boxes);
    space_.registerObjects(objects_);
    space_.setup();
  }
  // If many bodies move, update() of all is faster.
  void Step(Ids ids, Boxes boxes) override {
    SetBoxes(ids, boxes);
    if (4 * ids.size() > bodies_.size()) {
      space_.update();
    } else {
      space_.update(objects_);
    }
  }

  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    if (2 * ids.size() > bodies_.size()) {
      PairsAmong(ids, found, [&](auto function) { ForEachPair(function); });
      return;
    }
    PairsByQueries(ids, found, [&](std::uint32_t a, auto function) {
      space_.collide(
          bodies_[a].get(), &function, [](Object* body, Object*, void* data) {
            (*static_cast<decltype(function)*>(data))(FclBody::IdOf(body));
            return false;
          });
    });
  }

  // AABB::equal(): update() of a list leaves these boxes as they were.
  float Slack() const override {
    return 100 * std::numeric_limits<float>::epsilon();
  }

 private:
  void SetBoxes(Ids ids, Boxes boxes) {
    objects_.clear();
    Store(ids, boxes, [&](std::uint32_t id, const Box& box) {
      bodies_[id]->SetBox(box);
      objects_.push_back(bodies_[id].get());
    });
  }
  template <typename Function>
  void ForEachPair(Function function) const {
    space_.collide(&function, [](Object* a, Object* b, void* data) {
      (*static_cast<Function*>(data))(FclBody::IdOf(a), FclBody::IdOf(b));
      return false;
    });
  }

  std::vector<std::unique_ptr<FclBody>> bodies_;
  std::vector<Object*> objects_;  // of the last change
  fcl::DynamicAABBTreeCollisionManager<float> space_;
};

// It does not see that a few bodies moved by less than a millionth of their
// distance from 0.
const Registered<BodySpace<3>> kFcl("FCL dynamic tree", [](std::size_t bodies) {
  return std::make_unique<FclSpace>(bodies);
});

}  // namespace
}  // namespace halfspace::bench
