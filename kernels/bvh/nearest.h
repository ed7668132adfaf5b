// The arguments of the kernels that search BVHs for what is nearest, or first
// along a line.
// No Highway here.
#ifndef HALFSPACE_KERNELS_BVH_NEAREST_H_
#define HALFSPACE_KERNELS_BVH_NEAREST_H_

#include <bit>
#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "kernels/bvh/shape.h"

namespace halfspace::detail {

// An object's key, its squared distance, above its slot: as keys are not
// negative, these are in the order of the objects.
using KeyedSlot = std::uint64_t;
inline KeyedSlot Keyed(float key, std::size_t slot) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(key)} << 32 | slot;
}
inline float KeyOf(KeyedSlot keyed) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(keyed >> 32));
}

// A point, or a box.
struct NearBox {
  std::size_t dims;
  std::size_t max_plane;  // the first maximum of bounds, or 0 without
  float low[3];
  float high[3];
};

struct NearestSearch {
  const BvhLevels* levels;
  NearBox box;
  std::uint32_t mask;
  KeyedSlot from;    // what is less was found before
  float limit;       // keys up to this are found; finite
  KeyedSlot* found;  // the least, ascending
  std::size_t room;  // for so many, at least one
};

// Returns the new limit of t; a negative one ends the search. `planes` has the
// object's value on plane p at p * kBlockObjects.
using LineFunction = float (*)(void* context, std::uint32_t id, float t,
                               const float* planes);

struct LineSearch {
  const BvhLevels* levels;
  Line line;  // up to its max_t, which is finite
  std::uint32_t mask;
  LineFunction function;
  void* context;
};

struct BvhNearestKernels {
  // Returns how many were found.
  std::size_t (*find)(const NearestSearch& search);
  void (*cast)(const LineSearch& search);
};

extern template struct KernelsOfAll<BvhNearestKernels>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_NEAREST_H_
