// Internal. The calls of sorted_shapes.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_SORTED_SHAPES_H_
#define HALFSPACE_DETAIL_SORTED_SHAPES_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/sorted.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace::detail {

inline constexpr std::size_t kMostHalfSpaces = 64;

struct SortedShapeQuery {
  enum Kind : std::uint8_t { kSphere, kSegment, kCapsule, kHalfSpaces };
  Kind kind;
  std::uint8_t dims;
  const float* values;  // of the shape, or of all half-spaces
  std::size_t count;    // of half-spaces
};

HALFSPACE_API std::size_t SortedSurvivors(const SortedTree& tree,
                                          const SortedShapeQuery& query,
                                          Span<std::uint32_t> ids,
                                          const SortedOptions& options);
HALFSPACE_API std::size_t SortedCount(const SortedTree& tree,
                                      const SortedShapeQuery& query,
                                      const SortedOptions& options);
HALFSPACE_API bool SortedAny(const SortedTree& tree,
                             const SortedShapeQuery& query, std::uint32_t& id,
                             const SortedOptions& options);
HALFSPACE_API void SortedForEach(const SortedTree& tree,
                                 const SortedShapeQuery& query,
                                 IdsFunction function, void* context,
                                 const SortedOptions& options);

// Query q is at(queries, q). `queries` must have the alignment.
using ShapeQueryAt = SortedShapeQuery (*)(const void* queries, std::size_t q);
HALFSPACE_API std::size_t SortedSurvivorsOfMany(
    const SortedTree& tree, const void* queries, std::size_t query_count,
    std::size_t alignment, ShapeQueryAt at, Span<std::uint32_t> ids,
    Span<std::size_t> offsets, const SortedOptions& options);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_SORTED_SHAPES_H_
