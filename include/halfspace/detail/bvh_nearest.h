// Internal. The calls of bvh_nearest.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_BVH_NEAREST_H_
#define HALFSPACE_DETAIL_BVH_NEAREST_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// Returns the new limit; a negative one ends the search.
using NearFunction = float (*)(void* context, std::uint32_t id, float value);

HALFSPACE_API std::size_t BvhNearest(const BvhTree& tree, std::size_t dims,
                                     const float* point, float max_distance,
                                     Span<std::uint32_t> ids,
                                     Span<float> distances,
                                     const QueryOptions& options);
HALFSPACE_API void BvhForEachNearest(const BvhTree& tree, std::size_t dims,
                                     const float* point, float max_distance,
                                     NearFunction function, void* context,
                                     const QueryOptions& options);
// `ray` has the origin, the direction and max_t.
HALFSPACE_API void BvhRayCast(const BvhTree& tree, std::size_t dims,
                              const float* ray, float radius,
                              NearFunction function, void* context,
                              const QueryOptions& options);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_BVH_NEAREST_H_
