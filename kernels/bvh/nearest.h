// The parameters of the kernels that search a BVH for the nearest objects, or
// for the objects that a line enters first. No Highway here.
#ifndef HALFSPACE_KERNELS_BVH_NEAREST_H_
#define HALFSPACE_KERNELS_BVH_NEAREST_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "kernels/bvh/shape_query.h"
#include "kernels/compiler.h"

namespace halfspace::detail {

// The key of an object, which is its squared distance, in the bits above its
// slot. Keys are not negative, so these integers have the order of the
// distances.
using KeyedSlot = std::uint64_t;
inline KeyedSlot Keyed(float key, std::size_t slot) {
  return std::uint64_t{kernels::BitCast<std::uint32_t>(key)} << 32 | slot;
}
inline float KeyOf(KeyedSlot keyed) {
  return kernels::BitCast<float>(static_cast<std::uint32_t>(keyed >> 32));
}

struct NearestSearch {
  const BvhLevels* levels;
  NearBox box;
  std::uint32_t mask;
  bool is_exclusive;  // leaves out the objects whose box is this one
  KeyedSlot from;     // what is less was found before
  float limit;        // keys up to this are found; finite
  KeyedSlot* found;   // the least, ascending
  std::size_t room;   // for so many, at least one
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
