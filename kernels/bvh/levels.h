// The levels of a BVH, as kernels read and write them. No Highway here.
#ifndef HALFSPACE_KERNELS_BVH_LEVELS_H_
#define HALFSPACE_KERNELS_BVH_LEVELS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"

namespace halfspace::detail {

// 64 to the power of this is more than 2^32.
inline constexpr std::size_t kMostLevels = 6;

// If a tree has room for more objects than this, its leaves have codes. So a
// tree with codes has a level 2, where PlainWalk begins (walk-inl.h).
inline constexpr std::size_t kMostWithoutCodes = kBlockObjects * kBlockObjects;

// The bit of an object or a node, or of an id, in its word.
constexpr std::uint64_t BitOf(std::size_t i) {
  return std::uint64_t{1} << i % kBlockObjects;
}

// Level 0 has the objects. Node i of another level encloses block i of the
// level below it: 64 consecutive objects or nodes.
struct BvhLevel {
  std::size_t size = 0;
  // Block after block. Each block has 64 floats of each plane: first of all
  // minima, then of all maxima.
  float* floats = nullptr;
  std::size_t planes = 0;
  // One bit per object or node: whether it exists. Erased objects and nodes
  // without objects are Empty().
  std::uint64_t* present = nullptr;
  // One bit per node with maxima: whether all of its objects exist and have
  // min <= max on each axis. If such a node is inside a query, all of its
  // objects survive.
  std::uint64_t* regular = nullptr;
  // The masks of each object. A node has the union of the masks of its objects.
  // Null if no masks were set.
  std::uint32_t* masks = nullptr;
  // Whether the level is so large that queries prefetch it.
  bool is_prefetched = false;

  float* Plane(std::size_t block, std::size_t plane) const {
    return floats + (block * planes + plane) * kBlockObjects;
  }
  // The union of the masks of a block.
  std::uint32_t MasksOf(std::size_t block) const {
    std::uint32_t all = 0;
    for (std::size_t i = 0; i < kBlockObjects; ++i) {
      all |= masks[block * kBlockObjects + i];
    }
    return all;
  }
  float& Value(std::size_t plane, std::size_t i) const {
    return Plane(i / kBlockObjects, plane)[i % kBlockObjects];
  }
};

// How the values of objects become codes (kernels/bvh/kernel_table.h). Lane k
// has the minima of axis k, lane kMaxLane + k the negated maxima.
struct alignas(64) CodeMap {
  static constexpr std::size_t kMaxLane = 4;
  static constexpr std::size_t kLanes = 8;
  float base[kLanes];
  float scale[kLanes];
};

// Statistics of a range of slots: about how many of its blocks queries visit,
// and the number of its objects.
struct BvhGroup {
  double cost;
  std::uint64_t objects;
};

struct BvhLevels {
  std::size_t count = 0;
  std::array<BvhLevel, kMostLevels> level{};
  CodeMap* map = nullptr;
  // Block after block as the floats of level 0. Null with room for up to
  // kMostWithoutCodes objects: a query then reads the floats.
  std::int16_t* codes = nullptr;
  std::uint32_t* ids = nullptr;  // of objects, by slot; kNoId of none
  // The slot of each id. A free id can have any number. Null until a change.
  std::uint32_t* slots = nullptr;
  std::uint64_t* used = nullptr;  // a UsedIds of all objects, with `slots`
  BvhGroup* built = nullptr;      // 1024 slots each, when they were last sorted
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_LEVELS_H_
