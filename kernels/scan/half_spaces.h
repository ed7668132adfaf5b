// Half-spaces as the query of a flat scan. No Highway here.
#ifndef HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_
#define HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_

#include <cstddef>
#include <cstdint>

#include "kernels/bvh/shape_query.h"
#include "kernels/scan/kernel_table.h"

namespace halfspace::detail {

// A sum with one product a term has the sign of HalfSpaceSum(), unless it is
// nearer to 0 than this times the greatest number that it reads, or than
// kLeastSlack (docs/bvh.md).
inline constexpr float kSumSlack = 0x1p-17f;
inline constexpr float kLeastSlack = 0x1p-110f;

struct HalfSpaceQuery {
  HalfSpaceTests tests;
  bool rejects_all;
  // The kernel reads the words, and clears the bits of objects with a corner
  // behind a half-space. Otherwise it writes the survivors.
  bool is_of_insides = false;
  float box[6];  // of the tests, as a query of boxes; or of spheres
  // Spheres must be at most as far away from the box as their radius and this.
  // Without dimensions there is no box.
  std::uint8_t near_dims;
  std::uint32_t radius_plane;  // of spheres; else a number of no plane
  float radius;
  // The greatest number of the box and of the negative offsets, for bounds that
  // touch the box. Infinity if it depends on the bounds.
  float size;
  // The first two tests read all planes.
  bool is_paired;
  // Numbers of the tests that can reject.
  std::uint8_t front[kMostHalfSpaces];
  std::uint8_t front_count;
  // All tests read the same planes, one for each term. Otherwise a term has a
  // minimum and a maximum.
  bool is_shared;
  std::uint8_t terms;
};

// Called in the default floating-point mode.
void MakeHalfSpaceQuery(const PlaneLayout& layout, const ShapeScan& shape,
                        HalfSpaceQuery& query);

// One kernel for any planes of floats, and for every enumerator of ScanKernel.
// Its query is a HalfSpaceQuery.
extern template struct KernelsOfAll<TargetKernels>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_SCAN_HALF_SPACES_H_
