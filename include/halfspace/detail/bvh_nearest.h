// Internal. The calls of bvh_nearest.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_BVH_NEAREST_H_
#define HALFSPACE_DETAIL_BVH_NEAREST_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace {

struct SearchOptions;

namespace detail {

// Returns the new limit; a negative one ends the search. `planes` has the
// object's value on plane p at p * kBlockObjects.
using NearFunction = float (*)(void* context, std::uint32_t id, float value,
                               const float* planes);

// Boxes, or points, whose corners are equal. The lower corner of box i is at
// values[i * stride], and the upper one is `upper` values behind it.
struct NearQueries {
  const float* values;
  std::size_t upper;
  std::size_t stride;
  std::size_t count;
};

HALFSPACE_API std::size_t BvhNearest(const BvhTree& tree,
                                     const NearQueries& query,
                                     float max_distance,
                                     Span<std::uint32_t> ids,
                                     Span<float> distances,
                                     const SearchOptions& options);
HALFSPACE_API void BvhNearestOfEach(const BvhTree& tree,
                                    const NearQueries& queries, std::size_t k,
                                    float max_distance, Span<std::uint32_t> ids,
                                    Span<float> distances,
                                    const SearchOptions& options);
HALFSPACE_API void BvhForEachNearest(const BvhTree& tree,
                                     const NearQueries& query,
                                     float max_distance, NearFunction function,
                                     void* context,
                                     const SearchOptions& options);

// A box from `low` to `high`, `radius` larger on each side, on its way.
struct LineCast {
  const char* call;
  const float* low;
  const float* high;
  const float* direction;
  float max_t;
  float radius;
};

HALFSPACE_API void BvhCast(const BvhTree& tree, const LineCast& cast,
                           NearFunction function, void* context,
                           const SearchOptions& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_BVH_NEAREST_H_
