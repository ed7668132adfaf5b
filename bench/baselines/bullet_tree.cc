#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

btDbvtVolume VolumeOf(const Aabb3& box) {
  return btDbvtVolume::FromMM(btVector3(box.min[0], box.min[1], box.min[2]),
                              btVector3(box.max[0], box.max[1], box.max[2]));
}

struct LeafTaker : btDbvt::ICollide {
  explicit LeafTaker(std::vector<std::uint32_t>& list) : found(list) {}

  void Process(const btDbvtNode* leaf) override {
    found.push_back(static_cast<std::uint32_t>(leaf->dataAsInt));
  }

  std::vector<std::uint32_t>& found;
};

class BulletTree : public BoxTree<3> {
 public:
  explicit BulletTree(std::span<const Aabb3> boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      btDbvtNode* leaf = tree_.insert(VolumeOf(boxes[i]), nullptr);
      leaf->dataAsInt = static_cast<int>(i);
    }
    tree_.optimizeTopDown();
  }

  void Find(const Aabb3& query,
            std::vector<std::uint32_t>& found) const override {
    found.clear();
    LeafTaker taker(found);
    tree_.collideTV(tree_.m_root, VolumeOf(query), taker);
  }

 private:
  btDbvt tree_;
};

// Built by insertion and then optimised from the top down. Coordinates are at
// most 1e12: where the volume of a box is no float, it writes beyond its
// arrays. Of more boxes a query takes ten times as long as others.
const Registered<BoxTree<3>> kBulletTree(
    "Bullet btDbvt",
    [](auto boxes) { return std::make_unique<BulletTree>(boxes); }, 100'000);

}  // namespace
}  // namespace halfspace::bench
