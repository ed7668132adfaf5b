// How the axes of a world compare: the weights by which an order chooses the
// axis of a cut, and the grid of a curve.
#ifndef HALFSPACE_DISPATCH_BVH_AXES_H_
#define HALFSPACE_DISPATCH_BVH_AXES_H_

#include <array>
#include <cstdint>
#include <optional>

#include "kernels/bvh/kernel_table.h"

namespace halfspace::detail {

// A query of extents q reads a node of extents e in a share of all cases that
// is the product of e[k] + q[k] over the axes. A cut of axis k halves e[k], so
// it saves most where e[k] / q[k] is greatest. weight[k] is 1 / q[k], relative
// to the greatest. So an order cuts where the extent times the weight is
// greatest.
struct AxisWeights {
  std::array<float, kCenterAxes> weight;
  bool is_given;  // by BuildOptions::query_extents

  // As a number, for the header of a blob. Weights are rounded to two bits
  // behind the leading one. All ones are no weights.
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::uint32_t Pack() const;
  static AxisWeights Unpack(std::uint32_t packed);
};

// The weights for queries of the given extents, or else for queries that are
// about as large as the objects, rounded as by Pack(). The objects are sampled.
// Queries of points could have any extents: the square roots of the extents of
// all points are in the middle between a cube and the shape of the world.
AxisWeights WeightsOf(const PlaneLayout& layout, const Columns& objects,
                      const BvhKernels::OfPlanes& kernels,
                      const std::optional<std::array<float, 3>>& query_extents);

// The grid of a curve over most centers. Cells have the same extents, times the
// weights, on all axes.
Grid GridOf(const Columns& objects, const AxisWeights& weights,
            const BvhKernels::OfPlanes& kernels);

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_AXES_H_
