// How a query finds bodies whose bounds in the tree are late: it leaves them
// out of what the tree finds, and tests them by their records, 64 at a time, as
// a tree of one leaf. The same kernels test them, so they get the same answers.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_LATE_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_LATE_H_

#include <cstddef>
#include <cstdint>

#include "dispatch/broad_phase/state.h"
#include "kernels/bvh/levels.h"

namespace halfspace::detail {

class LateLeaf {
 public:
  explicit LateLeaf(const BroadPhaseState& state)
      : state_(state), tree_(state.type, MemoryResource()) {}
  LateLeaf(const LateLeaf&) = delete;
  LateLeaf& operator=(const LateLeaf&) = delete;

  // Calls test(tree) for each leaf of late bodies, until it returns false.
  // Returns whether it never did.
  template <typename Test>
  bool ForEach(const Reading& reading, const Test& test) {
    bool goes_on = true;
    state_.records.ForEachMarked([&](std::uint32_t id) {
      if (!reading.IsLate(id)) return true;
      Add(id);
      if (count_ == kBlockObjects) goes_on = Run(test);
      return goes_on;
    });
    return goes_on && (count_ == 0 || Run(test));
  }

 private:
  void Add(std::uint32_t id) {
    const BvhLevels& all = state_.tree.levels();
    WithAxes(state_.type.axes, [&](auto axes) {
      state_.records.Copy<decltype(axes)::value>(id, floats_ + count_);
    });
    ids_[count_] = id;
    const std::uint32_t* const masks = all.level[0].masks;
    masks_[count_] = masks == nullptr ? 0xFFFFFFFF : masks[all.slots[id]];
    ++count_;
  }

  template <typename Test>
  bool Run(const Test& test) {
    BvhLevels levels;
    levels.count = 1;
    levels.ids = ids_;
    levels.level[0].size = count_;
    levels.level[0].floats = floats_;
    levels.level[0].planes = state_.planes();
    levels.level[0].present = &present_;
    if (state_.tree.levels().level[0].masks != nullptr) {
      levels.level[0].masks = masks_;
    }
    present_ = ~std::uint64_t{0} >> (kBlockObjects - count_);
    count_ = 0;
    BvhState::Of(tree_).Borrow(levels);
    return test(tree_);
  }

  const BroadPhaseState& state_;
  BvhTree tree_;
  std::size_t count_ = 0;
  std::uint64_t present_ = 0;
  std::uint32_t ids_[kBlockObjects] = {};
  std::uint32_t masks_[kBlockObjects];
  alignas(64) float floats_[kMostBodyPlanes * kBlockObjects] = {};
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_LATE_H_
