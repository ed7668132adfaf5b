#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include "bench/baselines/body_space.h"

namespace halfspace::bench {
namespace {

btVector3 VectorOf(const Point<3>& p) { return {p[0], p[1], p[2]}; }

std::uint32_t IdOf(const btBroadphaseProxy* proxy) {
  return IdOfData(proxy->m_clientObject);
}

class BulletSpace : public BodySpace<3> {
 public:
  explicit BulletSpace(std::size_t bodies)
      : BodySpace(bodies),
        proxies_(bodies),
        space_(std::make_unique<btDbvtBroadphase>()) {}
  // destroyProxy() reads all pairs for each body.
  ~BulletSpace() override {
    space_.reset();
    for (btBroadphaseProxy* proxy : proxies_) {
      delete static_cast<btDbvtProxy*>(proxy);
    }
  }

  void Insert(Ids ids, Boxes boxes) override {
    Store(ids, boxes, [&](std::uint32_t id, const Box& box) {
      proxies_[id] = space_->createProxy(VectorOf(box.min), VectorOf(box.max),
                                         0, DataOf(id), 1, -1, nullptr);
    });
    space_->calculateOverlappingPairs(nullptr);
  }
  void Step(Ids ids, Boxes boxes) override {
    Store(ids, boxes, [&](std::uint32_t id, const Box& box) {
      space_->setAabb(proxies_[id], VectorOf(box.min), VectorOf(box.max),
                      nullptr);
    });
    space_->calculateOverlappingPairs(nullptr);
  }

  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    PairsAmong(ids, found, [&](auto function) { ForEachPair(function); });
  }

 private:
  template <typename Function>
  void ForEachPair(Function function) {
    const btBroadphasePairArray& pairs =
        space_->getOverlappingPairCache()->getOverlappingPairArray();
    for (int i = 0; i < pairs.size(); ++i) {
      function(IdOf(pairs[i].m_pProxy0), IdOf(pairs[i].m_pProxy1));
    }
  }

  std::vector<btBroadphaseProxy*> proxies_;
  std::unique_ptr<btDbvtBroadphase> space_;
};

// btDbvtBroadphase, with its cache of pairs.
const Registered<BodySpace<3>> kBulletSpace(
    "Bullet btDbvt",
    [](std::size_t bodies) { return std::make_unique<BulletSpace>(bodies); });

}  // namespace
}  // namespace halfspace::bench
