// The order of the objects of a BVH, which is its hierarchy: 64^k
// objects from a multiple of 64^k on are a node of level k.
#ifndef HALFSPACE_DISPATCH_BVH_ORDER_H_
#define HALFSPACE_DISPATCH_BVH_ORDER_H_

#include <cstddef>
#include <cstdint>

#include "kernels/bvh/block.h"

namespace halfspace::dispatch {

// Bytes of scratch memory for each object, aligned to 16.
inline constexpr std::size_t kOrderScratch = 16;

// By medians of the axis on which the centers are spread widest, each rounded
// to a multiple of the largest full node, until 64 objects are left. ids[p]
// becomes the object at position p.
void OrderByMedians(const detail::Columns& objects,
                    const detail::BvhKernels::OfPlanes& kernels,
                    std::byte* scratch, std::uint32_t* ids, const Runner& run);

// Along Hilbert's curve through 2^30 cells, in linear time.
void OrderByCurve(const detail::Columns& objects,
                  const detail::BvhKernels::OfPlanes& kernels,
                  std::byte* scratch, std::uint32_t* ids, const Runner& run);

// The parts of OrderByCurve(). The grid of all objects:
detail::Grid GridOf(const detail::Columns& objects,
                    const detail::BvhKernels::OfPlanes& kernels);

struct CurveKey {
  std::uint32_t place;
  std::uint32_t id;
};
static_assert(2 * sizeof(CurveKey) == kOrderScratch);

// Returns the keys of objects begin ... end - 1, sorted by place, and by id
// where places are equal. The keys are in the scratch memory.
const CurveKey* KeysByCurve(const detail::Columns& objects, std::size_t begin,
                            std::size_t end, const detail::Grid& grid,
                            const detail::BvhKernels::OfPlanes& kernels,
                            std::byte* scratch, const Runner& run);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_BVH_ORDER_H_
