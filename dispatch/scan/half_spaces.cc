// Half-spaces as a query of kernels, and the calls of kernels.h that take them.
#include "kernels/scan/half_spaces.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dispatch/bvh/shape_query.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/scan/prepare.h"
#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "halfspace/bounds.h"
#include "halfspace/c/kernels.h"

namespace halfspace::detail {

namespace {

// Gives the radius the largest of its factors in all tests, if they differ by
// at most 2^-18 of it, which is more than the lengths of unit vectors do after
// rounding. Otherwise returns false.
bool ShareRadius(HalfSpaceTests& tests, std::size_t radius_term) {
  float least = std::numeric_limits<float>::infinity();
  float most = 0;
  for (std::size_t f = 0; f < tests.count; ++f) {
    const float factor = tests.test[f].term[radius_term].more;
    least = std::min(least, factor);
    most = std::max(most, factor);
  }
  if (least < most * (1 - 0x1p-18f)) return false;
  for (std::size_t f = 0; f < tests.count; ++f) {
    tests.test[f].term[radius_term].more = most;
  }
  return true;
}

}  // namespace

void MakeHalfSpaceQuery(const PlaneLayout& layout, const ShapeScan& shape,
                        HalfSpaceQuery& query) {
  HalfSpaceTests& tests = query.tests;
  MakeHalfSpaceTests(layout, shape.half_spaces, shape.count, tests);
  HalfSpaceTest* const first = tests.test;
  HalfSpaceTest* const end = first + tests.count;
  HalfSpaceTest* const last = std::partition(
      first, end, [](const HalfSpaceTest& test) { return test.terms != 0; });
  query.rejects_all = std::any_of(
      last, end, [](const HalfSpaceTest& test) { return test.offset < 0; });
  tests.count = static_cast<std::size_t>(last - first);
  const HalfSpaceTest* const full_end = std::partition(
      first, last,
      [&](const HalfSpaceTest& test) { return test.terms >= layout.dims; });
  query.full_count = static_cast<std::size_t>(full_end - first);
  const bool is_sphere = layout.kind == PlaneLayout::kSphere;
  query.terms = layout.has_max ? layout.dims : 0;
  if (is_sphere) {
    query.terms = layout.dims + (ShareRadius(tests, layout.dims) ? 0 : 1);
  }
  query.near_dims = 0;
  query.radius_plane = is_sphere ? layout.dims : HalfSpaceQuery::kNoPlane;
  const bool is_near = shape.low != nullptr;
  if (!is_near && tests.box_dims == 0) return;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    query.box[k] = is_near ? shape.low[k] : tests.low[k];
    query.box[layout.dims + k] = is_near ? shape.high[k] : tests.high[k];
  }
  if (!is_sphere) return;
  query.near_dims = layout.dims;
  query.radius = shape.radius;
  tests.box_dims = 0;
}

}  // namespace halfspace::detail

namespace halfspace::dispatch {
namespace {

void WriteMask(const detail::PlaneLayout& layout, const float* const* planes,
               std::size_t n, const float* half_spaces, std::size_t count,
               std::uint64_t* mask) noexcept {
  assert(count <= detail::kMostHalfSpaces);
  detail::HalfSpaceQuery query;
  detail::ShapeScan shape{};
  shape.half_spaces = half_spaces;
  shape.count = count;
  InDefaultFpMode([&] { MakeHalfSpaceQuery(layout, shape, query); });
  detail::KernelsOfAll<detail::TargetKernels>::kTargets[IndexOf({},
                                                                "SurvivorsOf")]
      .mask_of_all[WideVectorsPay()](planes, 0, n, &query, mask);
}

}  // namespace
}  // namespace halfspace::dispatch

#define HALFSPACE_DEFINE_HALF_SPACE_MASK(bound, layout)                     \
  void bound##_half_space_mask(const float* const* planes, std::size_t n,   \
                               const float* half_spaces, std::size_t count, \
                               std::uint64_t* mask) noexcept {              \
    halfspace::dispatch::WriteMask(layout, planes, n, half_spaces, count,   \
                                   mask);                                   \
  }
HALFSPACE_DEFINE_HALF_SPACE_MASK(hs_box2,
                                 halfspace::detail::kLayoutOf<halfspace::Aabb2>)
HALFSPACE_DEFINE_HALF_SPACE_MASK(hs_box3,
                                 halfspace::detail::kLayoutOf<halfspace::Aabb3>)
HALFSPACE_DEFINE_HALF_SPACE_MASK(hs_octahedron2,
                                 halfspace::detail::kLayoutOf<halfspace::Aabo2>)
HALFSPACE_DEFINE_HALF_SPACE_MASK(hs_octahedron3,
                                 halfspace::detail::kLayoutOf<halfspace::Aabo3>)
HALFSPACE_DEFINE_HALF_SPACE_MASK(hs_sphere2,
                                 halfspace::detail::PlaneLayout::OfSpheres(2))
HALFSPACE_DEFINE_HALF_SPACE_MASK(hs_sphere3,
                                 halfspace::detail::PlaneLayout::OfSpheres(3))
