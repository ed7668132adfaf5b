// Half-spaces as a query of kernels, and the calls of kernels.h that take them.
#include "kernels/scan/half_spaces.h"

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>

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
  const bool is_sphere = layout.kind == PlaneLayout::kSphere;
  query.terms = 0;
  if (layout.has_max) query.terms = layout.dims;
  if (is_sphere) query.terms = layout.plane_count;
  query.rejects_all = false;
  query.full_count = 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < tests.count; ++f) {
    const HalfSpaceTest& test = tests.test[f];
    if (test.terms == 0) {
      query.rejects_all |= test.offset < 0;
      continue;
    }
    if (f != count) tests.test[count] = test;
    if (tests.test[count].terms == query.terms) {
      if (query.full_count != count) {
        std::swap(tests.test[query.full_count], tests.test[count]);
      }
      ++query.full_count;
    }
    ++count;
  }
  tests.count = count;
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
