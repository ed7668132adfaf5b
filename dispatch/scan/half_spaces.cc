// Half-spaces as a query of kernels, and the calls of kernels.h that take them.
#include "kernels/scan/half_spaces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dispatch/default_fp_mode.h"
#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "halfspace/bounds.h"
#include "halfspace/c/kernels.h"

namespace halfspace::detail {

void MakeHalfSpaceQuery(const PlaneLayout& layout, const ShapeScan& shape,
                        HalfSpaceQuery& query) {
  HalfSpaceTests& tests = query.tests;
  MakeHalfSpaceTests(layout, shape.half_spaces, shape.count, tests);
  query.rejects_all = false;
  query.radius_plane = layout.kind == PlaneLayout::kSphere
                           ? layout.dims
                           : std::numeric_limits<std::uint32_t>::max();
  query.is_shared = !layout.has_max;
  query.terms = layout.has_max ? layout.dims : layout.plane_count;
  query.front_count = 0;
  for (std::size_t f = 0; f < tests.count; ++f) {
    const HalfSpaceTest& test = tests.test[f];
    if (test.terms == 0) {
      query.rejects_all |= test.offset < 0;
      continue;
    }
    query.front[query.front_count++] = static_cast<std::uint8_t>(f);
  }
  // Also for NaN. Of a sphere that touches the box the center is anywhere.
  query.slack = std::numeric_limits<float>::infinity();
  query.near_dims = 0;
  const bool is_near = shape.low != nullptr;
  if (!is_near && tests.box_dims == 0) return;
  float most = 0;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    const float low = is_near ? shape.low[k] : tests.low[k];
    const float high = is_near ? shape.high[k] : tests.high[k];
    query.box[k] = low;
    query.box[layout.dims + k] = high;
    most = std::max({most, std::abs(low), std::abs(high)});
  }
  if (layout.kind != PlaneLayout::kSphere) {
    query.slack = kSumSlack * most + 0x1p-110f;
    return;
  }
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
