#include <box2d/b2_broad_phase.h>

#include "bench/baselines/body_space.h"

namespace halfspace::bench {
namespace {

b2Vec2 Box2dVectorOf(const Point<2>& p) { return {p[0], p[1]}; }

b2AABB Box2dBoxOf(const Aabb2& box) {
  b2AABB result;
  result.lowerBound = Box2dVectorOf(box.min);
  result.upperBound = Box2dVectorOf(box.max);
  return result;
}

class Box2dSpace : public BodySpace<2> {
 public:
  explicit Box2dSpace(std::size_t bodies)
      : BodySpace(bodies), proxies_(bodies), partners_(bodies) {}

  void Insert(Ids ids, Boxes boxes) override {
    Store(ids, boxes, [&](std::uint32_t id, const Box& box) {
      proxies_[id] = space_.CreateProxy(Box2dBoxOf(box), DataOf(id));
    });
    UpdateContacts();
  }
  void Step(Ids ids, Boxes boxes) override {
    Store(ids, boxes, [&](std::uint32_t id, const Box& box) {
      const Point<2>& last = boxes_[id].min;
      space_.MoveProxy(proxies_[id], Box2dBoxOf(box),
                       {box.min[0] - last[0], box.min[1] - last[1]});
    });
    UpdateContacts();
  }

  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    PairsAmong(ids, found, [&](auto function) { ForEachPair(function); });
  }

  // b2BroadPhase::UpdatePairs() calls it.
  void AddPair(void* a_data, void* b_data) {
    IndexPair pair = {IdOfData(a_data), IdOfData(b_data)};
    if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
    std::vector<std::uint32_t>& partners = partners_[pair[0]];
    if (std::find(partners.begin(), partners.end(), pair[1]) !=
        partners.end()) {
      return;
    }
    partners.push_back(pair[1]);
    contacts_.push_back(pair);
  }

 private:
  template <typename Function>
  void ForEachPair(Function function) const {
    for (const IndexPair& pair : contacts_) function(pair[0], pair[1]);
  }

  void UpdateContacts() {
    space_.UpdatePairs(this);
    for (std::size_t i = 0; i < contacts_.size();) {
      const IndexPair pair = contacts_[i];
      if (space_.TestOverlap(proxies_[pair[0]], proxies_[pair[1]])) {
        ++i;
        continue;
      }
      std::vector<std::uint32_t>& partners = partners_[pair[0]];
      *std::find(partners.begin(), partners.end(), pair[1]) = partners.back();
      partners.pop_back();
      contacts_[i] = contacts_.back();
      contacts_.pop_back();
    }
  }

  b2BroadPhase space_;
  std::vector<std::int32_t> proxies_;
  std::vector<IndexPair> contacts_;
  std::vector<std::vector<std::uint32_t>> partners_;  // the greater ones
};

// With a list of contacts as b2ContactManager's.
const Registered<BodySpace<2>> kBox2d("Box2D", [](std::size_t bodies) {
  return std::make_unique<Box2dSpace>(bodies);
});

}  // namespace
}  // namespace halfspace::bench
