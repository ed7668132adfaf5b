#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include "bench/baselines/body_space.h"

namespace halfspace::bench {
namespace {

btVector3 VectorOf(const Point<3>& p) { return {p[0], p[1], p[2]}; }

// The exact box, which is in each proxy.
Aabb3 BoxOf(const btBroadphaseProxy* proxy) {
  const btVector3& min = proxy->m_aabbMin;
  const btVector3& max = proxy->m_aabbMax;
  return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
}

std::uint32_t IdOf(const btBroadphaseProxy* proxy) {
  return IdOfData(proxy->m_clientObject);
}

struct FindCallback : btBroadphaseAabbCallback {
  FindCallback(const BodyQuery<3>& q, std::vector<std::uint32_t>& list)
      : query(q), found(list) {}

  // It goes on whatever this returns.
  bool process(const btBroadphaseProxy* proxy) override {
    if (query.is_first && !found.empty()) return false;
    if (query.Finds(BoxOf(proxy))) found.push_back(IdOf(proxy));
    return true;
  }

  const BodyQuery<3>& query;
  std::vector<std::uint32_t>& found;
};

struct CastCallback : btBroadphaseRayCallback {
  CastCallback(const BodyCast<3>& c, CastHits& h) : cast(c), hits(h) {
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      m_rayDirectionInverse[k] = cast.inverse[axis];
      m_signs[k] = cast.inverse[axis] < 0 ? 1 : 0;
    }
    m_lambda_max = cast.max_t;
  }

  bool process(const btBroadphaseProxy* proxy) override {
    hits.Test(cast, BoxOf(proxy));
    return true;
  }

  const BodyCast<3>& cast;
  CastHits& hits;
};

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

  void Find(const BodyQuery<3>& query,
            std::vector<std::uint32_t>& found) const override {
    FindCallback callback(query, found);
    space_->aabbTest(VectorOf(query.box.min), VectorOf(query.box.max),
                     callback);
  }
  // From 0, so that its box is where the cast begins. Its limit cannot shrink.
  void Cast(const BodyCast<3>& cast, CastHits& hits) const override {
    CastCallback callback(cast, hits);
    const btVector3 zero(0, 0, 0);
    space_->rayTest(zero, zero, callback, VectorOf(cast.box.min),
                    VectorOf(cast.box.max));
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

// btDbvtBroadphase, with its cache of pairs. Its casts do not find a body that
// they only touch.
const Registered<BodySpace<3>> kBullet("Bullet btDbvt", [](std::size_t bodies) {
  return std::make_unique<BulletSpace>(bodies);
});

}  // namespace
}  // namespace halfspace::bench
