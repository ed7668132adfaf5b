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
  enum Kind : std::uint8_t { kSphere, kSegment, kCapsule, kHalfSpaces };
  Kind kind;
  std::uint8_t dims;
  const float* values;  // of the shape, or of all half-spaces
  std::size_t count;    // of half-spaces
};

HALFSPACE_API std::size_t BvhSurvivors(const BvhTree& tree,
                                       const BvhShapeQuery& query,
                                       Span<std::uint32_t> ids,
                                       const QueryOptions& options);
HALFSPACE_API std::size_t BvhCount(const BvhTree& tree,
                                   const BvhShapeQuery& query,
                                   const QueryOptions& options);
HALFSPACE_API bool BvhAny(const BvhTree& tree, const BvhShapeQuery& query,
                          std::uint32_t& id, const QueryOptions& options);
HALFSPACE_API void BvhForEach(const BvhTree& tree, const BvhShapeQuery& query,
                              IdsFunction function, void* context,
                              const QueryOptions& options);

// Query q is at(queries, q). `queries` must have the alignment.
using ShapeQueryAt = BvhShapeQuery (*)(const void* queries, std::size_t q);
HALFSPACE_API std::size_t BvhSurvivorsOfMany(
    const BvhTree& tree, const void* queries, std::size_t query_count,
    std::size_t alignment, ShapeQueryAt at, Span<std::uint32_t> ids,
    Span<std::size_t> offsets, const QueryOptions& options);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_BVH_SHAPES_H_
