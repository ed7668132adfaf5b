// Internal. The calls of reject.h after the types are gone: the boundary
// between the caller's translation unit and the library. Not part of the
// interface.
#ifndef HALFSPACE_DETAIL_SCAN_H_
#define HALFSPACE_DETAIL_SCAN_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"

namespace halfspace {

struct Options;
struct SurvivorCount;
struct SurvivorFlag;

namespace detail {

enum class Shape : std::uint8_t { kSimplex, kAabb, kAabo };

// One world and one query. Both lists hold all minima, then all maxima; a
// simplex world has only minima, its query only maxima. Left uninitialised
// past the planes of the shape: clearing 120 bytes costs a tenth of a call.
struct Scan {
  Shape shape;
  int dims;
  std::size_t size;
  std::array<const float*, kMaxPlanes> planes;
  std::array<float, kMaxPlanes> query;
};

template <int kDims>
constexpr Shape ShapeOf(const SimplexView<kDims>&) {
  return Shape::kSimplex;
}
template <int kDims>
constexpr Shape ShapeOf(const AabbView<kDims>&) {
  return Shape::kAabb;
}
template <int kDims>
constexpr Shape ShapeOf(const AaboView<kDims>&) {
  return Shape::kAabo;
}

template <typename View>
Scan ScanOf(const View& view, const typename View::Query& query) {
  Scan scan;
  scan.shape = ShapeOf(view);
  scan.dims = View::Bound::kDimensions;
  scan.size = view.size;
  std::size_t p = 0;
  for (const float* plane : view.min) scan.planes[p++] = plane;
  if constexpr (HasMax<View>) {
    for (const float* plane : view.max) scan.planes[p++] = plane;
  }
  p = 0;
  if constexpr (HasMin<typename View::Query>) {
    for (float v : query.min) scan.query[p++] = v;
  }
  for (float v : query.max) scan.query[p++] = v;
  return scan;
}

HALFSPACE_API Target RejectMask(const Scan& scan, std::span<std::uint64_t> mask,
                                const Options& options);
HALFSPACE_API Target SurvivorMask(const Scan& scan,
                                  std::span<std::uint64_t> mask,
                                  const Options& options);
HALFSPACE_API SurvivorCount Survivors(const Scan& scan,
                                      std::span<std::uint32_t> indices,
                                      const Options& options);
HALFSPACE_API SurvivorCount CountSurvivors(const Scan& scan,
                                           const Options& options);
HALFSPACE_API SurvivorFlag AnySurvivor(const Scan& scan,
                                       const Options& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_SCAN_H_
