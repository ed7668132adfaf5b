#include "dispatch/confirm.h"

#include "kernels/prefetch.h"

namespace halfspace::dispatch {
namespace {

const float* ValueOf(const detail::Scan& scan, std::size_t plane,
                     std::size_t object) {
  return scan.confirming.planes[plane] + object * scan.confirming.stride;
}

}  // namespace

void PrefetchFloats(const detail::Scan& scan, std::size_t object) {
  const std::size_t planes = scan.plane_count;
  // A record may lie across two cache lines; planes are a line each.
  const std::size_t step = scan.confirming.stride == 1 ? 1 : planes - 1;
  for (std::size_t p = 0; p < planes; p += step) {
    kernels::Prefetch(ValueOf(scan, p, object));
  }
}

// One object at a time: so few are left that a vector would be mostly idle.
bool FloatsReject(const detail::Scan& scan, const float* query, std::size_t i) {
  const std::size_t axes = scan.axes;
  const bool has_maxima = scan.shape != detail::Shape::kSimplex;
  const float* query_max = has_maxima ? query + axes : query;
  bool rejected = false;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= *ValueOf(scan, k, i) > query_max[k];
  }
  if (!has_maxima) return rejected;
  for (std::size_t k = 0; k < axes; ++k) {
    rejected |= *ValueOf(scan, axes + k, i) < query[k];
  }
  return rejected;
}

}  // namespace halfspace::dispatch
