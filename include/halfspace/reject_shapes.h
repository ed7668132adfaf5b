// Half-spaces, for example a frustum: which of the stored bounds could be in
// front of all of them? And which of some stored spheres could touch a shape?
//
//   const Frustum3 seen = FrustumPlanes(matrix, ClipDepth::kZeroToOne);
//   indices.resize(halfspace::Survivors(world, seen, indices));
//
//   const SphereView3 spheres = {{x, y, z}, radius, count};
//   halfspace::SurvivorMask(spheres, seen, mask);
//
// This header adds to the calls of reject.h:
//   - a type of query: any list of up to 64 HalfSpace<d> (shapes.h), for a view
//     or an owning world of floats in 2 or 3 dimensions. frustum.h makes that
//     of a camera;
//   - a type of view: SphereView<d>, for queries by such a list, an Aabb<d>, a
//     RoundedBox<d> or a Sphere<d>.
// The schedule of the options has no effect.
//
// A bound survives if its corner that is foremost along the normal of each
// half-space is in front of it. For an AABO it is the corner of its box. These
// are the objects that the queries of bvh_shapes.h find. bvh_shapes.h says what
// is exact, and what half-spaces with a NaN or an infinity do. An empty list of
// half-spaces keeps every object.
//
// A large object can be behind no half-space and yet outside, near a corner of
// the region. Add the sides of an axis-aligned box around the region, as
// FrustumPlanes() does: an axis-aligned half-space costs a compare, and objects
// outside of the box are tested no further.
//
// A sphere survives if it reaches in front of each half-space, and if its
// distance from the box, or the center, is at most the sum of the radii. The
// axis-aligned half-spaces of a list are such a box. No sphere that touches the
// exact shape is rejected, in any floating-point mode. Spheres closer than
// about 2^-17 of the sizes involved can survive. All targets return the same
// spheres.
// A NaN in a box or a center rejects nothing on its side. In half-spaces a NaN
// of a center rejects nothing, and an infinity nothing where a normal has a 0.
// A box with a minimum above its maximum is that far from every sphere, and
// Empty() finds none of finite radius. Of a sphere with a negative radius the
// result is unspecified.
//
// Errors: as RejectMask() in reject.h. There must be at most 64 half-spaces,
// and the pointer to them must not be null or misaligned. The radius of a query
// must not be negative or NaN.
//
// Floating-point mode: as in bvh_shapes.h. A call can raise inexact, overflow,
// underflow and invalid. A program that enables floating-point traps must
// disable these four during a call.
//
// Thread safety: as in reject.h, with 9 KiB more stack.
//
// Cost: three products and sums an object and half-space, and a compare an
// axis-aligned one. A sphere takes one product and sum more, or one for each
// half-space if the lengths of the normals differ by more than 2^-18.
// `./bench.sh
// --details culling` compares it with loops by hand, which fuse products and
// sums: not every target can, and all return the same objects. From a few
// thousand objects on, a BVH is faster.
//
// Source: the support function of a box is common knowledge. Spheres: "The
// Bounding Simplex: A SIMD-Era Rejection Primitive", section 2.1.
#ifndef HALFSPACE_REJECT_SHAPES_H_
#define HALFSPACE_REJECT_SHAPES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/detail/scan.h"
#include "halfspace/frustum.h"
#include "halfspace/reject.h"  // IWYU pragma: export
#include "halfspace/shapes.h"
#include "halfspace/span.h"

namespace halfspace {

// Stored spheres, in the caller's memory: coordinate k of the center of sphere
// i is center[k][i], and its radius is radius[i], which must not be negative.
// The rest is as in AabbView (world.h). A NaN counts as touching whatever it is
// compared with.
template <int kDims>
struct SphereView {
  static_assert(kDims == 2 || kDims == 3, "spheres have 2 or 3 dimensions");
  std::array<const float*, static_cast<std::size_t>(kDims)> center{};
  const float* radius = nullptr;
  std::size_t size = 0;

  const SphereView& view() const { return *this; }
};
using SphereView2 = SphereView<2>;
using SphereView3 = SphereView<3>;

}  // namespace halfspace

namespace halfspace::detail {

template <typename Query>
inline constexpr bool kIsList =
    std::is_convertible_v<const Query&, Span<const HalfSpace<2>>> ||
    std::is_convertible_v<const Query&, Span<const HalfSpace<3>>>;
template <typename View>
inline constexpr bool kHasInside = HasMax<typename View::Bound>;
template <int kDims>
inline constexpr bool kHasInside<SphereView<kDims>> = true;

template <int kDims>
const float* ValuesOf(Span<const HalfSpace<kDims>> list) {
  static_assert(sizeof(list[0]) == (kDims + 1) * sizeof(float),
                "half-spaces are read as a list of their values");
  return reinterpret_cast<const float*>(list.data());
}

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

  static ShapeScan Of(const View& view, Span<const HalfSpace<kDims>> list) {
    return {ScanOf(view, nullptr, 0), ValuesOf(list), list.size()};
  }
};

template <int kDims>
constexpr ScanType MakeSphereType() {
  ScanType type{};
  static_cast<PlaneLayout&>(type) = PlaneLayout::OfSpheres(kDims);
  type.flat = kMinima;
  type.element_bytes = sizeof(float);
  type.record_bytes = (kDims + 1) * sizeof(float);
  type.query_bytes = sizeof(float);
  return type;
}
template <int kDims>
inline constexpr ScanType kSphereType = MakeSphereType<kDims>();

template <int kDims>
Scan SphereScanOf(const SphereView<kDims>& view) {
  static_assert(
      std::is_standard_layout_v<SphereView<kDims>> &&
          offsetof(SphereView<kDims>, radius) == kDims * sizeof(const float*),
      "the planes of a view are read as one list");
  Scan scan;
  scan.type = &kSphereType<kDims>;
  scan.planes = view.center.data();
  scan.addresses = AddressesOf(
      view.center.data(), std::make_index_sequence<std::size_t{kDims} + 1>());
  scan.size = view.size;
  scan.queries = nullptr;
  scan.query_count = 0;
  return scan;
}

template <int kDims, typename Query>
struct Asked<SphereView<kDims>, Query,
             std::enable_if_t<std::is_convertible_v<
                 const Query&, Span<const HalfSpace<kDims>>>>> {
  static ShapeScan Of(const SphereView<kDims>& view,
                      Span<const HalfSpace<kDims>> list) {
    return {SphereScanOf(view), ValuesOf(list), list.size()};
  }
};
template <int kDims>
struct Asked<SphereView<kDims>, Sphere<kDims>> {
  static ShapeScan Of(const SphereView<kDims>& view,
                      const Sphere<kDims>& query) {
    const float* const center = query.center.data();
    return {SphereScanOf(view), nullptr, 0, center, center, query.radius};
  }
};
template <int kDims>
struct Asked<SphereView<kDims>, Aabb<kDims>> {
  static ShapeScan Of(const SphereView<kDims>& view, const Aabb<kDims>& query) {
    return {SphereScanOf(view), nullptr,          0,
            query.min.data(),   query.max.data(), 0};
  }
};
template <int kDims>
struct Asked<SphereView<kDims>, RoundedBox<kDims>> {
  static ShapeScan Of(const SphereView<kDims>& view,
                      const RoundedBox<kDims>& query) {
    return {SphereScanOf(view),   nullptr,     0, query.box.min.data(),
            query.box.max.data(), query.radius};
  }
};

}  // namespace halfspace::detail

namespace halfspace {

// Writes two masks: the survivors, as SurvivorMask() does, and those of them
// that are inside: every corner is in front of all half-spaces, up to about
// 2^-17 of the sizes involved. The others straddle a half-space. So a hierarchy
// over the objects can stop testing: a box or octahedron in one that is inside
// survives the same half-spaces, and so does a sphere, up to that distance.
//
// `world` is a view or world of AABBs or AABOs, or a SphereView. `half_spaces`
// is a list of them. `survivors` and `inside` must each have room for
// MaskWords(n) words, and must not overlap. An object is not inside if a number
// that a half-space reads is a NaN. An empty list has every object inside.
//
// Errors, thread safety and floating-point mode: as SurvivorMask(). Cost: that
// of SurvivorMask(), and 1 to 3 ns more for each object of a word that has a
// survivor.
template <typename AnyWorld, typename HalfSpaces,
          typename Asked = detail::AskedOf<AnyWorld, HalfSpaces>>
void ClassifyMasks(const AnyWorld& world, const HalfSpaces& half_spaces,
                   Span<std::uint64_t> survivors, Span<std::uint64_t> inside,
                   const Options& options = {}) {
  static_assert(detail::kIsList<HalfSpaces>,
                "objects are classified by a list of half-spaces");
  static_assert(detail::kHasInside<std::decay_t<decltype(world.view())>>,
                "a simplex has no corner that is nearest to a half-space: "
                "classify boxes, octahedra or spheres");
  detail::ClassifyMasks(Asked::Of(world.view(), half_spaces), survivors, inside,
                        options);
}

// Writes the survivor masks of several frusta, such as the cascades of a
// shadow, cameras or lights: that of frustum q begins at rows[q * row_words]. A
// `row_words` below MaskWords(n) counts as MaskWords(n). Errors and cost: those
// of a SurvivorMask() for each frustum, one after another.
template <typename AnyWorld>
void SurvivorMasks(const AnyWorld& world, Span<const Frustum3> frusta,
                   Span<std::uint64_t> rows, const Options& options = {},
                   std::size_t row_words = 0) {
  const std::size_t size = world.view().size;
  const std::size_t end = options.range.end < size ? options.range.end : size;
  const std::size_t words =
      options.range.begin < end ? MaskWords(end - options.range.begin) : 0;
  const std::size_t stride = row_words < words ? words : row_words;
  for (std::size_t q = 0; q < frusta.size(); ++q) {
    const std::size_t first =
        stride == 0 || q <= rows.size() / stride ? q * stride : rows.size();
    SurvivorMask(world, frusta[q],
                 Span<std::uint64_t>(rows.data() + first, rows.size() - first),
                 options);
  }
}

}  // namespace halfspace

#endif  // HALFSPACE_REJECT_SHAPES_H_
