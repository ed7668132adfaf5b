// Internal. The calls of sorted_nearest.h after the types are gone. Not part of
// the interface.
#ifndef HALFSPACE_DETAIL_SORTED_NEAREST_H_
#define HALFSPACE_DETAIL_SORTED_NEAREST_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/sorted.h"
#include "halfspace/export.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// Returns the new limit; a negative one ends the search.
using NearFunction = float (*)(void* context, std::uint32_t id, float value);

HALFSPACE_API std::size_t SortedNearest(const SortedTree& tree,
                                        std::size_t dims, const float* point,
                                        float max_distance,
                                        Span<std::uint32_t> ids,
                                        Span<float> distances,
                                        const SortedOptions& options);
HALFSPACE_API void SortedForEachNearest(const SortedTree& tree,
                                        std::size_t dims, const float* point,
                                        float max_distance,
                                        NearFunction function, void* context,
                                        const SortedOptions& options);
// `ray` has the origin, the direction and max_t.
HALFSPACE_API void SortedForEachAlongRay(const SortedTree& tree,
                                         std::size_t dims, const float* ray,
                                         float radius, NearFunction function,
                                         void* context,
                                         const SortedOptions& options);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DETAIL_SORTED_NEAREST_H_
