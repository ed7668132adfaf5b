// Half-spaces as the query of a flat scan. No Highway here.
#ifndef HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_
#define HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_

#include <cstddef>
#include <cstdint>

#include "kernels/bvh/shape_query.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::detail {

struct HalfSpaceQuery {
  // Without those that reject nothing or everything. First those with a term
  // for each axis, then those whose normal has a 0.
  HalfSpaceTests tests;
  std::size_t full_count;
  // The terms of each full test, without that of a radius that all of them
  // multiply by the same factor. 0 for simplices.
  std::size_t terms;
  bool rejects_all;
  // The kernel reads the words, and clears the bits of objects with a corner
  // behind a half-space. Otherwise it writes the survivors.
  bool only_insides = false;
  float box[6];  // of the tests, as a query of boxes; or of spheres
  // Spheres must be at most as far away from the box as their radius and this.
  // Without dimensions there is no box.
  std::uint8_t near_dims;
  std::uint32_t radius_plane;  // of spheres; else kNoPlane
  float radius;

  static constexpr std::uint32_t kNoPlane = ~std::uint32_t{0};
};

// One kernel for any planes of floats, and for every enumerator of ScanKernel.
// Its query is a HalfSpaceQuery.
extern template struct KernelsOfAll<TargetKernels>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_
