// Shapes as the kernels of BVHs read them, and the kernels that do.
// They read a list of planes, so that there is one for all worlds. No Highway
// here.
#ifndef HALFSPACE_KERNELS_BVH_SHAPE_H_
#define HALFSPACE_KERNELS_BVH_SHAPE_H_

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bvh.h"
#include "kernels/bvh/block.h"

namespace halfspace::detail {

// The points whose squared distance from the center, as computed, is at most
// the limit.
struct Ball {
  std::size_t dims;
  std::size_t max_plane;  // the first maximum, or 0 without
  float center[3];
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

// The slabs of a bound on a line from t = 0 on: first the planes by which the
// line enters them, then those by which it leaves.
struct Line {
  std::size_t entering;
  std::size_t planes;
  LinePlane plane[8];
  float max_t;
};

// By how much t must be apart on two planes to count as apart: far above what
// is lost where subnormals are flushed.
inline constexpr float kApartOnLine = 0x1p-100f;

// A t that is not above the exact one: a smaller one could be, by what is lost
// of a subnormal.
inline float ReportedTime(float t) { return t < kApartOnLine ? 0 : t; }

// A half-space as a sum of planes of a bound, each times a factor that was
// rounded up and down. It is negative of bounds that lie behind.
struct Front {
  struct Term {
    std::uint32_t plane;
    std::uint32_t opposite;  // the plane of the bound's nearest corner
    float more;
    float less;
  };
  std::size_t terms;
  float offset;
  Term term[4];
};

// Half-spaces, and a box that the bounds must touch too.
struct Fronts {
  std::size_t box_dims = 0;  // 0 without a box
  std::size_t max_plane;     // the first maximum
  float low[3];
  float high[3];
  std::size_t count;
  Front front[kMostHalfSpaces];
};

// Walks whose query is a Ball, a Line or Fronts.
struct BvhShapeKernels {
  struct OfShape {
    WalkFunction find;
    WalkFunction count;
  };
  OfShape ball;
  OfShape line;
  OfShape fronts;
};

extern template struct KernelsOfAll<BvhShapeKernels>;

// At least the value, by up to two ulps.
inline float RoundedUp(double value) {
  return static_cast<float>(value + std::abs(value) * 0x1p-23 + 0x1p-149);
}

// All in the default floating-point mode.
void MakeBall(const PlaneLayout& planes, const float* center, float radius,
              Ball& ball);
// Of a box from `low` to `high`, `radius` larger on each side, that moves by
// t * `direction`. A point has low == high. A bound is passed if the box
// touches it on each axis by itself, D included.
void MakeLine(const PlaneLayout& planes, const double* low, const double* high,
              const double* direction, float max_t, float radius, Line& line);
Front MakeFront(const PlaneLayout& planes, const float* normal, float offset);
// MakeFront() of a normal whose largest component is 1, and of its opposite, of
// bounds with maxima: less than half the time.
template <std::size_t kDims>
void MakeFronts(const PlaneLayout& planes, const float* normal, float offset,
                float opposite_offset, Front* two);

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_SHAPE_H_
