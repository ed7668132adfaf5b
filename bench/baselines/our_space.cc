#include <type_traits>

#include "bench/baselines/body_space.h"
#include "halfspace/broad_phase.h"
#include "halfspace/bvh.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::bench {
namespace {

template <int kDims, typename World>
class OurSpace : public BodySpace<kDims> {
  using Base = BodySpace<kDims>;
  using typename Base::Boxes;
  using typename Base::Ids;
  static constexpr bool kIsBvh = std::is_same_v<World, Bvh<AabbView<kDims>>>;

 public:
  explicit OurSpace(std::size_t bodies, World world = World())
      : Base(bodies), world_(std::move(world)) {}

  void Insert(Ids ids, Boxes boxes) override {
    if constexpr (kIsBvh) {
      world_ = World(boxes);
    } else {
      world_.Insert(ids, boxes);
      world_.Update();
    }
  }
  void Step(Ids ids, Boxes boxes) override {
    if constexpr (!kIsBvh) {
      world_.Move(ids, boxes);
      world_.Update();
    } else {
      if (ids.size() == world_.size()) {  // all ids are 0, 1, and so on
        world_.Refit(boxes);
      } else {
        world_.Set(ids, boxes);
      }
      // As BroadPhase::Update() does.
      if (world_.CostRatio() > 1.25) {
        world_.RebuildPartial(std::max<std::size_t>(1, world_.size() / 16));
      }
    }
  }
  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    ForEachPairOf(world_, ids, [&](Span<const IdPair> pairs) {
      for (const IdPair& pair : pairs) found.push_back({pair.a, pair.b});
    });
  }

 private:
  World world_;
};

template <int kDims>
struct RegisterOurs {
  RegisterOurs() {
    using Space = BroadPhase<AabbView<kDims>>;
    using Tree = Bvh<AabbView<kDims>>;
    Register("halfspace", [](std::size_t bodies) {
      return std::make_unique<OurSpace<kDims, Space>>(bodies);
    });
    Register("halfspace, caller's lock", [](std::size_t bodies) {
      return std::make_unique<OurSpace<kDims, Space>>(
          bodies, Space({.caller_locks = true}));
    });
    Register("halfspace Bvh", [](std::size_t bodies) {
      return std::make_unique<OurSpace<kDims, Tree>>(bodies);
    });
  }
  template <typename Make>
  void Register(const char* name, Make make) {
    Registered<BodySpace<kDims>>(name, make).All().back().is_ours = true;
  }
};
const RegisterOurs<2> kOurs2;
const RegisterOurs<3> kOurs3;

}  // namespace
}  // namespace halfspace::bench
