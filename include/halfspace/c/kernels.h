// Kernels for C, and for languages that call C: which of n bounds in the
// caller's memory could touch a query? C99, and C++11 or later.
//
//   const float* planes[6] = {min_x, min_y, min_z, max_x, max_y, max_z};
//   float query[6] = {0, 0, 0, 1, 1, 1};  /* min x y z, max x y z */
//   hs_box3_mask(planes, n, query, mask); /* mask: (n + 63) / 64 words */
//
// halfspace/kernels.h is the manual: the C++ functions there call these. A
// function of C++ and its function here:
//
//   SurvivorsOfBoxes3(planes, n, query, mask)     hs_box3_mask
//   SurvivorsOfBoxes3(planes, n, queries, count,  hs_box3_masks
//                     masks)
//   the same of boxes of doubles                  hs_box3_mask_of_doubles,
//                                                 hs_box3_masks_of_doubles
//
//   SurvivorsOfBoxes3(planes, n, half_spaces,     hs_box3_half_space_mask
//                     count, mask)
//
// The others are named hs_box, hs_simplex and hs_octahedron, with 2, 3 or 4;
// those of 4 need a library built with -DHALFSPACE_DIMS="2;3;4". Those for
// half-spaces are named hs_box, hs_octahedron and hs_sphere, with 2 or 3
// dimensions. `count` must be at most 64, which is not checked. A half-space is
// d + 1 floats: its normal, which points to what is kept, and its offset.
// hs_frustum_planes() (c/halfspace.h) makes those of a camera.
//
// The library has all functions with and without HALFSPACE_C.
#ifndef HALFSPACE_C_KERNELS_H_
#define HALFSPACE_C_KERNELS_H_

#include <stddef.h>
#include <stdint.h>

#include "halfspace/export.h"

#ifdef __cplusplus
#define HALFSPACE_NOEXCEPT noexcept
extern "C" {
#else
#define HALFSPACE_NOEXCEPT
#endif

#define HALFSPACE_DECLARE_MASKS(bound)                                   \
  HALFSPACE_API void bound##_mask(const float* const* planes, size_t n,  \
                                  const float* query, uint64_t* mask)    \
      HALFSPACE_NOEXCEPT;                                                \
  HALFSPACE_API void bound##_masks(const float* const* planes, size_t n, \
                                   const float* queries, size_t count,   \
                                   uint64_t* masks) HALFSPACE_NOEXCEPT
#define HALFSPACE_DECLARE_MASKS_OF_DOUBLES(bound)                   \
  HALFSPACE_DECLARE_MASKS(bound);                                   \
  HALFSPACE_API void bound##_mask_of_doubles(                       \
      const double* const* planes, size_t n, const double* query,   \
      uint64_t* mask) HALFSPACE_NOEXCEPT;                           \
  HALFSPACE_API void bound##_masks_of_doubles(                      \
      const double* const* planes, size_t n, const double* queries, \
      size_t count, uint64_t* masks) HALFSPACE_NOEXCEPT

HALFSPACE_DECLARE_MASKS_OF_DOUBLES(hs_box2);
HALFSPACE_DECLARE_MASKS_OF_DOUBLES(hs_box3);
HALFSPACE_DECLARE_MASKS_OF_DOUBLES(hs_box4);
HALFSPACE_DECLARE_MASKS(hs_simplex2);
HALFSPACE_DECLARE_MASKS(hs_simplex3);
HALFSPACE_DECLARE_MASKS(hs_simplex4);
HALFSPACE_DECLARE_MASKS(hs_octahedron2);
HALFSPACE_DECLARE_MASKS(hs_octahedron3);
HALFSPACE_DECLARE_MASKS(hs_octahedron4);

#define HALFSPACE_DECLARE_HALF_SPACE_MASK(bound)                      \
  HALFSPACE_API void bound##_half_space_mask(                         \
      const float* const* planes, size_t n, const float* half_spaces, \
      size_t count, uint64_t* mask) HALFSPACE_NOEXCEPT

HALFSPACE_DECLARE_HALF_SPACE_MASK(hs_box2);
HALFSPACE_DECLARE_HALF_SPACE_MASK(hs_box3);
HALFSPACE_DECLARE_HALF_SPACE_MASK(hs_octahedron2);
HALFSPACE_DECLARE_HALF_SPACE_MASK(hs_octahedron3);
HALFSPACE_DECLARE_HALF_SPACE_MASK(hs_sphere2);
HALFSPACE_DECLARE_HALF_SPACE_MASK(hs_sphere3);

#undef HALFSPACE_DECLARE_HALF_SPACE_MASK
#undef HALFSPACE_DECLARE_MASKS_OF_DOUBLES
#undef HALFSPACE_DECLARE_MASKS
#undef HALFSPACE_NOEXCEPT

#ifdef __cplusplus
}  // extern "C"
#endif

#endif  // HALFSPACE_C_KERNELS_H_
