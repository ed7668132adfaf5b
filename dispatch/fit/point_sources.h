// Points in the caller's memory: checked, and read.
#ifndef HALFSPACE_DISPATCH_FIT_POINT_SOURCES_H_
#define HALFSPACE_DISPATCH_FIT_POINT_SOURCES_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "dispatch/errors/memory_checks.h"
#include "halfspace/shapes.h"

namespace halfspace::dispatch {

// name() is made only for a message.
template <typename Scalar, typename Name>
void CheckPlace(std::string_view call, const Scalar* coords, std::size_t count,
                const Name& name) {
  CheckPointer(call, coords, alignof(Scalar), name,
               [&] { return std::to_string(count) + " points"; });
}

template <int kDims, typename Scalar>
void CheckPoints(std::string_view call, const Points<kDims, Scalar>& points) {
  CheckPlace(call, points.coords, points.count, [] { return "points.coords"; });
  CheckExtent(call, "points", sizeof(Scalar), points.count, points.stride,
              kDims);
}

template <int kDims, typename Scalar>
void CheckPoints(std::string_view call,
                 const PointsSoa<kDims, Scalar>& points) {
  for (std::size_t k = 0; k < kDims; ++k) {
    CheckPlace(call, points.coords[k], points.count,
               [&] { return "points.coords[" + std::to_string(k) + "]"; });
  }
  CheckExtent(call, "points", sizeof(Scalar), points.count, 1, 1);
}

template <int kDims, typename Scalar>
Point<kDims, Scalar> PointAt(const Points<kDims, Scalar>& points,
                             std::size_t i) {
  Point<kDims, Scalar> point;
  for (std::size_t k = 0; k < kDims; ++k) {
    point[k] = points.coords[i * points.stride + k];
  }
  return point;
}

template <int kDims, typename Scalar>
Point<kDims, Scalar> PointAt(const PointsSoa<kDims, Scalar>& points,
                             std::size_t i) {
  Point<kDims, Scalar> point;
  for (std::size_t k = 0; k < kDims; ++k) point[k] = points.coords[k][i];
  return point;
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_FIT_POINT_SOURCES_H_
