// The arguments of the kernels that search BVHs for what is nearest.
// No Highway here.
#ifndef HALFSPACE_KERNELS_BVH_NEAREST_H_
#define HALFSPACE_KERNELS_BVH_NEAREST_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "kernels/bvh/shape.h"

namespace halfspace::detail {

// An object's key, which is a squared distance or a place on a line, above its
// slot: as keys are not negative, these are in the order of the objects.
using KeyedSlot = std::uint64_t;

struct NearestSearch {
  const BvhLevels* levels;
  // The key is the squared distance from the ball's center, whose limit is not
  // read, or, if there is a line, where that enters.
  Ball ball;
  const Line* line;
  std::uint32_t masks;
  KeyedSlot from;    // what is less was found before
  float limit;       // keys up to this are found; finite
  KeyedSlot* found;  // the least, ascending
  std::size_t room;  // for so many, at least one
};

struct BvhNearestKernels {
  // Returns how many were found.
  std::size_t (*find)(const NearestSearch& search);
};

// Of each compiled target, best first.
extern const BvhNearestKernels* const kBvhNearestKernels;

// Specialised by each target's pass.
template <std::int64_t kTarget>
inline constexpr BvhNearestKernels kBvhNearestKernelsFor{};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_NEAREST_H_
