// Half-spaces, for example a frustum: which of the stored bounds could be in
// front of all of them?
//
//   const std::array<HalfSpace3, 6> frustum = ...;
//   indices.resize(halfspace::Survivors(world, frustum, indices));
//
// This header adds a type of query to the calls of reject.h: any list of up to
// 64 HalfSpace<d> (shapes.h), for a view or an owning world of floats in 2 or 3
// dimensions. The schedule of the options has no effect.
//
// An object survives if the corner of its bound that is foremost along the
// normal of each half-space is in front of it. For an AABO it is the corner of
// its box. These are the objects that the queries of bvh_shapes.h find.
// bvh_shapes.h says what is exact, and what half-spaces with a NaN, an infinity
// or a tiny component do. An empty list of half-spaces keeps every object.
//
// A large object can be behind no half-space and yet outside, near a corner of
// the region. Add the sides of an axis-aligned box around the region, as
// FrustumPlanes() does (frustum.h): an axis-aligned half-space costs a compare,
// and objects outside of the box are tested no further.
//
// Errors: as RejectMask() in reject.h. There must be at most 64 half-spaces,
// and the pointer to them must not be null or misaligned.
//
// Floating-point mode: as in bvh_shapes.h. A call can raise inexact, overflow,
// underflow and invalid. A program that enables floating-point traps must
// disable these four during a call.
//
// Thread safety: as in reject.h, with 6 KiB more stack.
//
// Cost: three multiply-adds an object and half-space, and a compare an
// axis-aligned one. `./bench.sh --details culling` compares it with loops by
// hand. What those lack costs up to a third: without a box around the region,
// each plane is also read for its magnitude, from which follows which sums are
// too near to 0 to decide. From a few thousand objects on, a BVH is faster.
//
// Source: the support function of a box is common knowledge.
#ifndef HALFSPACE_REJECT_SHAPES_H_
#define HALFSPACE_REJECT_SHAPES_H_

#include <cstddef>
#include <type_traits>

#include "halfspace/detail/scan.h"
#include "halfspace/reject.h"  // IWYU pragma: export
#include "halfspace/shapes.h"
#include "halfspace/span.h"

namespace halfspace::detail {

// Any list of half-spaces. Quantized bounds, which have no `Planes`, are not
// tested by them.
template <typename View, typename HalfSpaces>
struct Asked<
    View, HalfSpaces,
    std::enable_if_t<sizeof(typename View::Planes) != 0 &&
                     std::is_convertible_v<
                         const HalfSpaces&,
                         Span<const HalfSpace<View::Bound::kDimensions>>>>> {
  static constexpr std::size_t kDims = View::Bound::kDimensions;
  static_assert(kDims <= 3, "half-spaces are for 2 and 3 dimensions");
  static_assert(std::is_same_v<typename View::Bound::Scalar, float>,
                "half-spaces are for worlds of floats");

  static HalfSpaceScan Of(const View& view, Span<const HalfSpace<kDims>> list) {
    static_assert(sizeof(list[0]) == (kDims + 1) * sizeof(float),
                  "half-spaces are read as a list of their values");
    return {ScanOf(view, nullptr, 0),
            reinterpret_cast<const float*>(list.data()), list.size()};
  }
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_REJECT_SHAPES_H_
