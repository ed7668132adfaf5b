#include "bench/baselines/body_space.h"
#include "halfspace/reject.h"
#include "halfspace/world.h"

namespace halfspace::bench {
namespace {

template <int kDims>
class ScanSpace : public BodySpace<kDims> {
  using Base = BodySpace<kDims>;
  using typename Base::Box;
  using typename Base::Boxes;
  using typename Base::Ids;

 public:
  explicit ScanSpace(std::size_t bodies) : Base(bodies), survivors_(bodies) {
    world_.Resize(bodies);
    for (std::size_t i = 0; i < bodies; ++i) world_.Set(i, Box::Empty());
  }

  void Insert(Ids ids, Boxes boxes) override { Step(ids, boxes); }
  void Step(Ids ids, Boxes boxes) override {
    this->Store(ids, boxes,
                [&](std::uint32_t id, const Box& box) { world_.Set(id, box); });
  }

  void PairsOf(Ids ids, std::vector<IndexPair>& found) override {
    this->PairsByQueries(ids, found, [&](std::uint32_t a, auto function) {
      const std::size_t count = Survivors(world_, this->boxes_[a], survivors_);
      for (std::size_t i = 0; i < count; ++i) function(survivors_[i]);
    });
  }

 private:
  World<AabbView<kDims>> world_;
  std::vector<std::uint32_t> survivors_;
};

template <int kDims>
std::unique_ptr<BodySpace<kDims>> MakeScan(std::size_t bodies) {
  return std::make_unique<ScanSpace<kDims>>(bodies);
}
// With more bodies a frame takes seconds.
const Registered<BodySpace<2>> kScan2("scan", &MakeScan<2>, 4096);
const Registered<BodySpace<3>> kScan3("scan", &MakeScan<3>, 4096);

}  // namespace
}  // namespace halfspace::bench
