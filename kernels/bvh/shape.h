// Shapes as the kernels of BVHs read them, and the kernels that do.
// They read a list of planes, so that there is one for all worlds. No Highway
// here.
#ifndef HALFSPACE_KERNELS_BVH_SHAPE_H_
#define HALFSPACE_KERNELS_BVH_SHAPE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "halfspace/detail/bvh.h"
#include "halfspace/detail/bvh_shapes.h"

namespace halfspace::detail {

// What planes a world has; plane `axes` is the first maximum.
struct ShapePlanes {
  std::size_t dims;
  std::size_t axes;
  bool has_max;
};

// The points whose squared distance from the center, as computed, is at most
// the limit.
struct Ball {
  std::size_t dims;
  std::size_t max_plane;  // the first maximum, or 0 without
  float center[3];
  float limit;
};

// Where a line passes a plane: at t = (value - offset) * inverse.
struct LinePlane {
  std::uint32_t plane;
  std::uint32_t lane;  // of BlockScale
  float offset;
  float inverse;
};

// The slabs of a bound on a line from t = 0 on: first the planes by which the
// line enters them, then those by which it leaves.
struct Line {
  std::size_t block_bytes;
  std::size_t entering;
  std::size_t planes;
  LinePlane plane[8];
  float max_t;
  // The same on the scales of a block, in its lanes.
  struct Codes {
    alignas(32) float factor[8];
    alignas(32) float offset[8];
    alignas(32) float outward[8];  // a small part: negative where it enters
    alignas(32) float more[8];     // of an axis on which it does not move
  } codes;
};

// By how much t must be apart on two planes to count as apart: far above what
// is lost where subnormals are flushed.
inline constexpr float kApartOnLine = 0x1p-100f;

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

// What a walk tests beside the query of its planes.
struct WalkShape {
  using Bits = std::uint64_t (*)(const WalkShape& shape, const BvhLevel& level,
                                 std::size_t first, std::uint64_t candidates);
  // Of the 64 objects or nodes of a level from `first` on, those of the
  // candidates that the shape may touch: tested instead of the query of planes,
  // or null if that is to be tested.
  Bits instead;
  // The same of what is kept so: of objects, and, unless there is `instead`, of
  // nodes. Null if `instead` tells all.
  Bits touching;
  // Those nodes of the candidates all of whose objects the shape is sure to
  // keep; null if there are none. Their minima are below their maxima.
  Bits inside;
  Ball ball;
  Line line;
  std::size_t front_count;
  Front fronts[kMostHalfSpaces];
};

struct BvhShapeKernels {
  WalkShape::Bits line_codes;  // keeps all that `line` keeps
  WalkShape::Bits ball;
  WalkShape::Bits in_ball;
  WalkShape::Bits line;
  WalkShape::Bits fronts;
  WalkShape::Bits in_fronts;
};

// Of each compiled target, best first.
extern const BvhShapeKernels* const kBvhShapeKernels;

// Specialised by each target's pass.
template <std::int64_t kTarget>
inline constexpr BvhShapeKernels kBvhShapeKernelsFor{};

// All in the default floating-point mode. `direction` is that of t = 1; D moves
// with the others. A bound is passed if it is within `radius` of the line, on
// each axis by itself.
Ball MakeBall(const ShapePlanes& planes, const float* center, float radius);
void MakeLine(const ShapePlanes& planes, const double* origin,
              const double* direction, float max_t, float radius, Line& line);
Front MakeFront(const ShapePlanes& planes, const float* normal, float offset);

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_SHAPE_H_
