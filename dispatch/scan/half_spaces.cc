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
  query.is_paired = false;
  // Two tests with opposite signs read all planes of a box. By the maxima that
  // a test reads: the place of such a test in the list, and 1.
  std::uint8_t place_of[8] = {};
  const std::size_t all_maxima = (std::size_t{1} << layout.dims) - 1;
  for (std::size_t f = 0; f < tests.count; ++f) {
    const HalfSpaceTest& test = tests.test[f];
    if (test.terms == 0) {
      query.rejects_all |= test.offset < 0;
      continue;
    }
    const std::uint8_t place = query.front_count++;
    query.front[place] = static_cast<std::uint8_t>(f);
    if (query.is_paired || !layout.has_max || test.terms != layout.dims) {
      continue;
    }
    std::size_t maxima = 0;
    for (std::size_t k = 0; k < layout.dims; ++k) {
      maxima |= std::size_t{test.term[k].more > 0} << k;
    }
    place_of[maxima] = place + 1;
    if (place_of[all_maxima - maxima] == 0) continue;
    std::swap(query.front[0], query.front[place_of[all_maxima - maxima] - 1]);
    std::swap(query.front[1], query.front[place]);
    query.is_paired = true;
  }
  query.near_dims = 0;
  const bool is_near = shape.low != nullptr;
  // Also for NaN. Of a sphere that touches the box the center is anywhere.
  query.size = std::numeric_limits<float>::infinity();
  if (!is_near && tests.box_dims == 0) return;
  float size = 0;
  for (std::size_t k = 0; k < layout.dims; ++k) {
    const float low = is_near ? shape.low[k] : tests.low[k];
    const float high = is_near ? shape.high[k] : tests.high[k];
    query.box[k] = low;
    query.box[layout.dims + k] = high;
    size = std::max({size, std::abs(low), std::abs(high)});
  }
  if (layout.kind != PlaneLayout::kSphere) {
    for (std::size_t f = 0; f < tests.count; ++f) {
      size = std::max(size, -tests.test[f].offset);
    }
    query.size = size;
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
