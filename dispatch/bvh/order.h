// The order of the objects of a BVH, which is its hierarchy: 64^k
// objects from a multiple of 64^k on are a node of level k.
#ifndef HALFSPACE_DISPATCH_BVH_ORDER_H_
#define HALFSPACE_DISPATCH_BVH_ORDER_H_

#include <cstddef>
#include <cstdint>

#include "dispatch/bvh/axes.h"
#include "kernels/bvh/kernel_table.h"

namespace halfspace::detail {

// Moves the entries that is_below() accepts to the front, and returns their
// end. As std::partition, but each standard library arranges the entries in its
// own way, and hierarchies would differ. It has no branches, because they would
// be mispredicted.
template <typename Entry, typename IsBelow>
Entry* Partition(Entry* first, Entry* end, const IsBelow& is_below) {
  for (Entry* e = first; e != end; ++e) {
    const Entry entry = *e;
    *e = *first;
    *first = entry;
    first += is_below(entry) ? 1 : 0;
  }
  return first;
}

// Bytes of scratch memory for each object, aligned to 16.
inline constexpr std::size_t kOrderScratch = 16;

// By medians of the axis on which the centers are spread widest, in units of
// the weights. Each median is rounded to a multiple of the largest full node,
// until 64 objects are left. ids[p] becomes the object at position p.
void OrderByMedians(const Columns& objects, const AxisWeights& weights,
                    const BvhKernels::OfPlanes& kernels, std::byte* scratch,
                    std::uint32_t* ids, const Runner& run);

// Along Hilbert's curve through 2^30 cells, in linear time, and in a cell of
// more than 64 objects by medians.
void OrderByCurve(const PlaneLayout& layout, const Columns& objects,
                  const AxisWeights& weights,
                  const BvhKernels::OfPlanes& kernels, std::byte* scratch,
                  std::uint32_t* ids, const Runner& run);

// The parts of OrderByCurve().

struct CurveKey {
  std::uint32_t place;
  std::uint32_t id;
};
static_assert(2 * sizeof(CurveKey) == kOrderScratch);

// Returns the keys of objects begin ... end - 1, sorted by place, and by id
// where places are equal. The keys are in the scratch memory.
const CurveKey* KeysByCurve(const Columns& objects, std::size_t begin,
                            std::size_t end, const Grid& grid,
                            const BvhKernels::OfPlanes& kernels,
                            std::byte* scratch, const Runner& run);

// Calls function(begin, end) for the positions of each cell of more than 64
// objects. place_of(i) is the cell at position i of the curve.
template <typename PlaceOf, typename Function>
void ForCrowdedCells(std::size_t count, const PlaceOf& place_of,
                     const Function& function) {
  for (std::size_t begin = 0, end; begin < count; begin = end) {
    end = begin + 1;
    while (end < count && place_of(end) == place_of(begin)) ++end;
    if (end - begin > kBlockObjects) function(begin, end);
  }
}

// Orders the ids of the `count` objects of a cell, which come to the slots from
// `first_slot` on, by medians.
void OrderCell(const PlaneLayout& layout, const Columns& objects,
               const AxisWeights& weights, const BvhKernels::OfPlanes& kernels,
               std::byte* scratch, std::uint32_t* ids, std::size_t count,
               std::size_t first_slot, const Runner& run);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_ORDER_H_
