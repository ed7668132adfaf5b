// Query shapes as the kernels of BVHs read them, and these kernels. They read a
// list of planes, so the same kernels serve all worlds. No Highway here.
#ifndef HALFSPACE_KERNELS_BVH_SHAPE_QUERY_H_
#define HALFSPACE_KERNELS_BVH_SHAPE_QUERY_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "kernels/bvh/kernel_table.h"

namespace halfspace::detail {

// A box, or a point, whose corners are equal.
struct NearBox {
  std::size_t dims;
  std::size_t max_plane;  // the first maximum of bounds, or 0 without
  float low[3];
  float high[3];
};

// The points whose squared distance from a point or a box, as computed, is at
// most the limit.
struct Ball {
  NearBox center;
  float limit;
  std::size_t d_axis;  // or 0 without
  float d_min;
  float d_max;
};

// Where a line passes a plane: at t = (value - offset) * inverse.
struct LinePlane {
  std::uint32_t plane;
  float offset;
  float inverse;
};

// A line from t = 0 on. First come the planes at which it enters the slabs of a
// bound, then the planes at which it leaves them.
struct Line {
  std::size_t entering;
  std::size_t planes;
  LinePlane plane[8];
  float max_t;
};

// A line misses a bound only if it leaves one slab by more than this before it
// enters another. This is far above what is lost if subnormals are flushed.
inline constexpr float kApartOnLine = 0x1p-100f;

// Returns a t that is not above the exact one. A t below kApartOnLine can be
// above it by what is lost of a subnormal, so 0 is returned.
inline float ReportedTime(float t) { return t < kApartOnLine ? 0 : t; }

// A half-space as a sum over planes of a bound, each multiplied by a factor. A
// simplex has factors that were rounded up and down, of which the greater
// product counts. The sum is negative for bounds behind the half-space.
inline constexpr std::size_t kMostTerms = 4;
struct HalfSpaceTest {
  struct Term {
    std::uint32_t plane;
    std::uint32_t opposite;  // the plane of the bound's nearest corner
    float more;
    float less;
  };
  std::size_t terms;
  float offset;
  Term term[kMostTerms];
};

// Half-spaces, and a box that the bounds must touch as well: the axis-aligned
// half-spaces of a list, which take a compare each.
struct HalfSpaceTests {
  std::size_t box_dims = 0;   // 0 without a box
  std::size_t max_plane = 0;  // the first maximum, or 0 without
  float low[3];
  float high[3];
  std::size_t count;
  HalfSpaceTest test[kMostHalfSpaces];
};

// Walks whose query is a Ball, a Line or HalfSpaceTests.
struct BvhShapeKernels {
  struct OfShape {
    WalkFunction find;
    WalkFunction count;
  };
  OfShape ball;
  OfShape line;
  OfShape half_spaces;
};

extern template struct KernelsOfAll<BvhShapeKernels>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_SHAPE_QUERY_H_
