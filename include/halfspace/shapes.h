// Shapes: the inputs of the builders of fit.h and fit_many.h.
//
// All are plain data in the caller's own unit. Structs with pointers own
// nothing: the memory that they point to must outlive the call. Pointers need
// the alignment of their element and no more; only the elements described are
// read. Scalar is float (the default) or double.
//
// Thread safety: plain values.
#ifndef HALFSPACE_SHAPES_H_
#define HALFSPACE_SHAPES_H_

#include <array>
#include <cstddef>

namespace halfspace {

// A point, a direction or a displacement.
template <int kDims, typename Scalar = float>
using Point = std::array<Scalar, static_cast<std::size_t>(kDims)>;

// Points as an array of structures: point i is coords[i * stride + 0 ..
// kDims - 1].
template <int kDims, typename Scalar = float>
struct Points {
  const Scalar* coords = nullptr;  // not read if count is 0
  std::size_t count = 0;
  std::size_t stride = kDims;  // scalars from one point to the next
};

// Points as a structure of arrays: point i is coords[0][i], coords[1][i], ...
template <int kDims, typename Scalar = float>
struct PointsSoa {
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> coords{};
  std::size_t count = 0;
};

// An axis-aligned box. Of floats, an Aabb (bounds.h) says the same.
template <int kDims, typename Scalar = float>
struct Box {
  Point<kDims, Scalar> min;
  Point<kDims, Scalar> max;
};

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

// The points origin + t * direction for 0 <= t <= max_t. The direction need not
// have length 1: max_t is a multiple of its length.
template <int kDims, typename Scalar = float>
struct Ray {
  Point<kDims, Scalar> origin;
  Point<kDims, Scalar> direction;
  Scalar max_t;
};

// The sphere of all points within `radius` of `center`.
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

// The points center + sum of s[i] * half_extents[i] * axes[i] for
// -1 <= s[i] <= 1. The axes need be neither of length 1 nor at right angles.
template <int kDims, typename Scalar = float>
struct OrientedBox {
  Point<kDims, Scalar> center;
  std::array<Point<kDims, Scalar>, static_cast<std::size_t>(kDims)> axes;
  Point<kDims, Scalar> half_extents;
};

// The points p with normal[0] * p[0] + ... + offset >= 0, which lie in front of
// a plane. The normal need not have length 1.
template <int kDims, typename Scalar = float>
struct HalfSpace {
  Point<kDims, Scalar> normal;
  Scalar offset;
};

// N boxes: coordinate k of box i is min[k][i * stride] and max[k][i * stride].
// Stride 1 is a structure of arrays, which is the fastest to read.
template <int kDims, typename Scalar = float>
struct Boxes {
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> min{};
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> max{};
  std::size_t count = 0;
  std::size_t stride = 1;  // scalars from one box to the next
};

// N spheres: coordinate k of center i is center[k][i * stride], its radius
// radius[i * stride].
template <int kDims, typename Scalar = float>
struct Spheres {
  std::array<const Scalar*, static_cast<std::size_t>(kDims)> center{};
  const Scalar* radius = nullptr;
  std::size_t count = 0;
  std::size_t stride = 1;  // scalars from one sphere to the next
};

// The map x -> linear * x + translation; linear[i] is row i, so that
// coordinate i of the image is linear[i][0] * x[0] + ... + translation[i].
template <int kDims, typename Scalar = float>
struct Affine {
  std::array<Point<kDims, Scalar>, static_cast<std::size_t>(kDims)> linear;
  Point<kDims, Scalar> translation;
};

using Point2 = Point<2>;
using Point3 = Point<3>;
using Point4 = Point<4>;
using Points2 = Points<2>;
using Points3 = Points<3>;
using Points4 = Points<4>;
using PointsSoa2 = PointsSoa<2>;
using PointsSoa3 = PointsSoa<3>;
using PointsSoa4 = PointsSoa<4>;
using Segment2 = Segment<2>;
using Segment3 = Segment<3>;
using Segment4 = Segment<4>;
using Triangle2 = Triangle<2>;
using Triangle3 = Triangle<3>;
using Triangle4 = Triangle<4>;
using Ray2 = Ray<2>;
using Ray3 = Ray<3>;
using Ray4 = Ray<4>;
using Sphere2 = Sphere<2>;
using Sphere3 = Sphere<3>;
using Sphere4 = Sphere<4>;
using Capsule2 = Capsule<2>;
using Capsule3 = Capsule<3>;
using Capsule4 = Capsule<4>;
using OrientedBox2 = OrientedBox<2>;
using OrientedBox3 = OrientedBox<3>;
using OrientedBox4 = OrientedBox<4>;
using HalfSpace3 = HalfSpace<3>;
using Boxes2 = Boxes<2>;
using Boxes3 = Boxes<3>;
using Boxes4 = Boxes<4>;
using Spheres2 = Spheres<2>;
using Spheres3 = Spheres<3>;
using Spheres4 = Spheres<4>;
using Affine2 = Affine<2>;
using Affine3 = Affine<3>;
using Affine4 = Affine<4>;

}  // namespace halfspace

#endif  // HALFSPACE_SHAPES_H_
