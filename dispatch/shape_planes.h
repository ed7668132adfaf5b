// How many planes the shape of a scan has.
#ifndef HALFSPACE_DISPATCH_SHAPE_PLANES_H_
#define HALFSPACE_DISPATCH_SHAPE_PLANES_H_

#include <cstddef>

#include "halfspace/detail/scan.h"

namespace halfspace::dispatch {

// Minima; as many maxima, unless it is a simplex.
inline std::size_t AxesOf(const detail::Scan& scan) {
  const auto dims = static_cast<std::size_t>(scan.dims);
  return scan.shape == detail::Shape::kAabb ? dims : dims + 1;
}

inline std::size_t PlanesOf(const detail::Scan& scan) {
  return scan.shape == detail::Shape::kSimplex ? AxesOf(scan)
                                               : 2 * AxesOf(scan);
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_SHAPE_PLANES_H_
