// Builders: the tightest bounds, in float, that surely enclose a shape.
//
// The contract: every finite float of the input is taken as an exact real
// number, and the bound that comes back encloses the exact real set those
// numbers describe. X, Y, ... copy their inputs; D is a sum, and is rounded
// outward, so its minimum is never above and its maximum never below the exact
// value. Two closed sets that intersect, touching included, are therefore never
// rejected, whichever builder and target made the two bounds.
//
// Every builder returns an Aabo: take its up() for the objects of a simplex
// world, its down() for the queries, its aabb() for a box.
//
// Shapes and units: coordinates in the caller's unit, |x| + |y| + ... up to
// 2^125. A point beyond that, or with a NaN or an infinity, cannot be bounded
// by finite floats: the result is Everything(), which never rejects, and the
// status counts it.
//
// Errors: only those named below, thrown as std::invalid_argument. Thread
// safety: pure functions. Rounding: the caller's rounding mode and its flushing
// of subnormals do not matter, and are as before afterwards; the library is
// compiled without fast-math and contraction whatever the caller's flags are.
// Source: "The Bounding Simplex", for the axes; the outward rounding is this
// library's own (docs/design.md).
#ifndef HALFSPACE_FIT_H_
#define HALFSPACE_FIT_H_

#include <cstddef>

#include "halfspace/bounds.h"
#include "halfspace/export.h"

namespace halfspace {

// Points in the caller's memory: point i is coords[i * stride + 0 .. kDims-1].
template <int kDims>
struct Points {
  const float* coords = nullptr;  // aligned to float; not read if count is 0
  std::size_t count = 0;
  std::size_t stride = kDims;  // floats from one point to the next
};

using Points2 = Points<2>;
using Points3 = Points<3>;
using Points4 = Points<4>;

// Counts what could not be bounded, over as many calls as it is passed to.
struct FitStatus {
  std::size_t calls = 0;             // results counted so far
  std::size_t everything = 0;        // how many of them became Everything()
  std::size_t first_everything = 0;  // the first such result, counted from 0;
                                     // meaningful if everything > 0
};

// Bounds the convex hull of a point set. No points: Empty(). A point with a
// NaN, an infinity or |x| + |y| + ... > 2^125: Everything().
//   Throws if, with count > 0, coords is null or misaligned, or the points do
//   not fit the address space.
//   X, Y, Z exact; D is the tightest float.
//   Cost: about 3 ns a point.
template <int kDims>
HALFSPACE_API Aabo<kDims> BoundPoints(const Points<kDims>& points,
                                      FitStatus* status = nullptr);

// Bounds an axis-aligned box: the same X, Y, Z, and the D of its corners.
//   A box with a NaN, an infinity or too large a value: Everything().
//   Empty() in, Empty() out. Throws if min[k] > max[k] in any other way.
template <int kDims>
HALFSPACE_API Aabo<kDims> BoundAabb(const Aabb<kDims>& box,
                                    FitStatus* status = nullptr);

}  // namespace halfspace

#endif  // HALFSPACE_FIT_H_
