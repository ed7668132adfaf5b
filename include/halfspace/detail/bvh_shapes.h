// Internal. The calls of bvh_shapes.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_BVH_SHAPES_H_
#define HALFSPACE_DETAIL_BVH_SHAPES_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace::detail {

inline constexpr std::size_t kMostHalfSpaces = 64;

struct BvhShapeQuery {
  enum Kind : std::uint8_t {
    kPoint,
    kSphere,
    kSegment,
    kCapsule,
    kOrientedBox,
    kHalfSpaces
  };
  Kind kind;
  std::uint8_t dims;
  const float* values;  // of the shape, or of all half-spaces
  std::size_t count;    // of half-spaces
};

// Walks for one shape after another. Throws if one of them is no shape, before
// the first walk. `world` is the shape of the tree's bounds.
HALFSPACE_API void BvhWalkShapes(const BvhShape& world,
                                 const BvhQueries& queries,
                                 const QueryOptions& options, const char* call,
                                 const Walk& walk);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_BVH_SHAPES_H_
