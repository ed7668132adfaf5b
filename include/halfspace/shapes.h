// Shapes: the inputs of the builders in fit.h and fit_many.h.
//
//   const halfspace::Sphere3 sphere = {{0, 0, 0}, 1.5f};
//   const halfspace::Points3 vertices = {coords, count};  // x y z x y z ...
//
// All shapes are plain data, in any unit. Scalar is float (the default) or
// double. Structs with pointers do not own the memory, which must outlive the
// call. Pointers must be aligned for their element type. A call reads only the
// elements that are described here.
//
// Thread safety: plain values.
#ifndef HALFSPACE_SHAPES_H_
#define HALFSPACE_SHAPES_H_

#include <array>
#include <cstddef>

#include "halfspace/bounds.h"

namespace halfspace {

// A point, a direction or a displacement.
template <int kDims, typename Scalar = float>
using Point = std::array<Scalar, static_cast<std::size_t>(kDims)>;

// Points as an array of structures. Coordinate k of point i is
// coords[i * stride + k].
template <int kDims, typename Scalar = float>
struct Points {
  const Scalar* coords = nullptr;  // not read if count is 0
  std::size_t count = 0;
  std::size_t stride = kDims;  // scalars from one point to the next
};

// Points as a structure of arrays. Coordinate k of point i is coords[k][i].
template <int kDims, typename Scalar = float>
struct PointsSoa {
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> coords{};
  std::size_t count = 0;
};

// The name of an Aabb where it is a shape.
template <int kDims, typename Scalar = float>
using Box = Aabb<kDims, Scalar>;

template <int kDims, typename Scalar = float>
struct Segment {
  Point<kDims, Scalar> a;
  Point<kDims, Scalar> b;
};

template <int kDims, typename Scalar = float>
struct Triangle {
  Point<kDims, Scalar> a;
  Point<kDims, Scalar> b;
  Point<kDims, Scalar> c;
};

// The points origin + t * direction for 0 <= t <= max_t. The direction can have
// any length; `max_t` is a multiple of it.
template <int kDims, typename Scalar = float>
struct Ray {
  Point<kDims, Scalar> origin;
  Point<kDims, Scalar> direction;
  Scalar max_t;
};

// All points within `radius` of `center`.
template <int kDims, typename Scalar = float>
struct Sphere {
  Point<kDims, Scalar> center;
  Scalar radius;
};

// All points within `radius` of the segment from a to b.
template <int kDims, typename Scalar = float>
struct Capsule {
  Point<kDims, Scalar> a;
  Point<kDims, Scalar> b;
  Scalar radius;
};

// All points within `radius` of a box.
template <int kDims, typename Scalar = float>
struct RoundedBox {
  Box<kDims, Scalar> box;
  Scalar radius;
};

// The points center + sum of s[i] * half_extents[i] * axes[i] for
// -1 <= s[i] <= 1. The axes can have any lengths, and any angles between them.
template <int kDims, typename Scalar = float>
struct OrientedBox {
  Point<kDims, Scalar> center;
  std::array<Point<kDims, Scalar>, static_cast<std::size_t>(kDims)> axes;
  Point<kDims, Scalar> half_extents;
};

// The points in front of a plane: all p with
// normal[0] * p[0] + ... + offset >= 0. The normal can have any length.
template <int kDims, typename Scalar = float>
struct HalfSpace {
  Point<kDims, Scalar> normal;
  Scalar offset;
};

// Many boxes. Coordinate k of box i is min[k][i * stride] and
// max[k][i * stride]. Stride 1 is a structure of arrays, the fastest to read.
// BoxesOf (fit_many.h) makes this from an array of Aabb.
template <int kDims, typename Scalar = float>
struct Boxes {
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> min{};
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> max{};
  std::size_t count = 0;
  std::size_t stride = 1;  // scalars from one box to the next
};

// Many spheres. Coordinate k of the center of sphere i is
// center[k][i * stride], and its radius is radius[i * stride].
template <int kDims, typename Scalar = float>
struct Spheres {
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> center{};
  const Scalar* radius = nullptr;
  std::size_t count = 0;
  std::size_t stride = 1;  // scalars from one sphere to the next
};

// The affine map x -> linear * x + translation. linear[i] is row i, so
// coordinate i of the image is linear[i][0] * x[0] + ... + translation[i].
template <int kDims, typename Scalar = float>
struct Affine {
  std::array<Point<kDims, Scalar>, static_cast<std::size_t>(kDims)> linear;
  Point<kDims, Scalar> translation;
};

using Point2 = Point<2>;
using Point3 = Point<3>;
using Points2 = Points<2>;
using Points3 = Points<3>;
using PointsSoa2 = PointsSoa<2>;
using PointsSoa3 = PointsSoa<3>;
using Segment2 = Segment<2>;
using Segment3 = Segment<3>;
using Triangle2 = Triangle<2>;
using Triangle3 = Triangle<3>;
using Ray2 = Ray<2>;
using Ray3 = Ray<3>;
using Sphere2 = Sphere<2>;
using Sphere3 = Sphere<3>;
using Capsule2 = Capsule<2>;
using Capsule3 = Capsule<3>;
using RoundedBox2 = RoundedBox<2>;
using RoundedBox3 = RoundedBox<3>;
using OrientedBox2 = OrientedBox<2>;
using OrientedBox3 = OrientedBox<3>;
using HalfSpace2 = HalfSpace<2>;
using HalfSpace3 = HalfSpace<3>;
using Boxes2 = Boxes<2>;
using Boxes3 = Boxes<3>;
using Spheres2 = Spheres<2>;
using Spheres3 = Spheres<3>;
using Affine2 = Affine<2>;
using Affine3 = Affine<3>;

}  // namespace halfspace

#endif  // HALFSPACE_SHAPES_H_
