// Bounds of many triangles and point sets of doubles.
#include <cstddef>
#include <cstdint>

#include "dispatch/fit/one_by_one.h"
#include "halfspace/fit.h"

namespace halfspace::detail {
namespace {

template <int kDims>
kernels::FitTally FitTriangles(const kernels::FitJob& job) {
  return FitEach<kDims>(job, [&](std::size_t i) {
    const std::uint32_t* const corners = job.indices + 3 * i;
    for (std::size_t c = 0; c < 3; ++c) {
      if (corners[c] >= job.columns.size) return Aabo<kDims>::Everything();
    }
    return BoundTriangle(Triangle<kDims, double>{
        ElementAt<kDims>(job, corners[0]), ElementAt<kDims>(job, corners[1]),
        ElementAt<kDims>(job, corners[2])});
  });
}

template <int kDims>
kernels::FitTally FitPointSets(const kernels::FitJob& job) {
  // Columns of points have a stride only where they are structures.
  const std::size_t stride = job.columns.stride;
  const bool is_soa = stride == 1;
  return FitEach<kDims>(job, [&](std::size_t i) {
    const std::size_t begin = i == 0 ? 0 : job.ends[i - 1];
    const std::size_t end = job.ends[i];
    if (begin > end || end > job.columns.size) return Aabo<kDims>::Everything();
    if (begin == end) return Aabo<kDims>::Empty();
    if (!is_soa) {
      return BoundPoints(Points<kDims, double>{
          job.columns.doubles(0) + begin * stride, end - begin, stride});
    }
    PointsSoa<kDims, double> points;
    points.count = end - begin;
    for (std::size_t k = 0; k < kDims; ++k) {
      points.coords[k] = job.columns.doubles(k) + begin;
    }
    return BoundPoints(points);
  });
}

}  // namespace

const FitKernels* const kFitPointsOfDoubles[2][3] = {
    {&kOneByOne<&FitTriangles<2>>, &kOneByOne<&FitTriangles<3>>,
     &kOneByOne<&FitTriangles<4>>},
    {&kOneByOne<&FitPointSets<2>>, &kOneByOne<&FitPointSets<3>>,
     &kOneByOne<&FitPointSets<4>>}};

}  // namespace halfspace::detail
