// A leaf of some bodies' own bounds. The kernels of a query test it as they
// test the tree, so what they find is what they find in a Bvh of these bounds.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_EXACT_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_EXACT_H_

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/tree.h"

namespace halfspace::detail {

inline bool HasMask(const BodyMasks& masks, std::uint64_t mask) {
  return ~mask == 0 || (masks.category & mask) != 0;
}

// Whether the bounds overlap, as the kernels test them: with a NaN they do. In
// any floating-point mode, and without branches, which nothing predicts.
inline bool DoOverlap(const float* a, const float* b, std::size_t axes) {
  bool are_apart = false;
  for (std::size_t k = 0; k < axes; ++k) {
    are_apart |= std::isgreater(a[k], b[axes + k]);
    are_apart |= std::isgreater(b[k], a[axes + k]);
  }
  return !are_apart;
}

// The planes of an object of a leaf, from the first one on. They stay before
// later loads.
inline void LoadPlanes(const float* of_tree, std::size_t planes, float* to) {
  for (std::size_t p = 0; p < planes; ++p) {
    auto& plane = const_cast<float&>(of_tree[p * kBlockObjects]);
    to[p] = std::atomic_ref<float>(plane).load(std::memory_order_acquire);
  }
}

class ExactLeaf {
 public:
  explicit ExactLeaf(std::size_t planes) {
    BvhLevel& level = levels_.level[0];
    levels_.count = 1;
    levels_.ids = ids_;
    level.floats = floats_;
    level.planes = planes;
    level.present = &present_;
  }
  ExactLeaf(const ExactLeaf&) = delete;
  ExactLeaf& operator=(const ExactLeaf&) = delete;

  std::size_t size() const { return levels_.level[0].size; }
  void Clear() { levels_.level[0].size = 0; }
  void Add(std::uint32_t id, const Body& body) {
    BvhLevel& level = levels_.level[0];
    const std::size_t lane = level.size++;
    bodies_[lane] = id;
    ids_[lane] = static_cast<std::uint32_t>(lane);
    for (std::size_t p = 0; p < level.planes; ++p) {
      level.Plane(0, p)[lane] = body.planes[p];
    }
  }

  // What the kernels read. They read whole vectors.
  const BvhLevels& Finish() {
    constexpr std::size_t kMostLanes = 16;
    const BvhLevel& level = levels_.level[0];
    const std::size_t end = (size() + kMostLanes - 1) / kMostLanes * kMostLanes;
    for (std::size_t p = 0; p < level.planes; ++p) {
      std::fill(level.Plane(0, p) + size(), level.Plane(0, p) + end, 0.0f);
    }
    std::fill(ids_ + size(), ids_ + end, 0);
    present_ = ~std::uint64_t{0} >> (kBlockObjects - size());
    return levels_;
  }

  // The kernels find lanes.
  std::uint32_t IdOf(std::uint32_t lane) const { return bodies_[lane]; }
  void PlanesOf(std::uint32_t lane, float* planes) const {
    const BvhLevel& level = levels_.level[0];
    for (std::size_t p = 0; p < level.planes; ++p) {
      planes[p] = level.Plane(0, p)[lane];
    }
  }

 private:
  BvhLevels levels_;
  std::uint64_t present_ = 0;
  std::uint32_t bodies_[kBlockObjects];
  std::uint32_t ids_[kBlockObjects];
  alignas(64) float floats_[kMostBodyPlanes * kBlockObjects];
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_EXACT_H_
