// Bounds of many shapes of doubles: those of fit.h, one after the other.
#include <cstddef>
#include <cstdint>

#include "halfspace/detail/bulk.h"
#include "halfspace/fit.h"
#include "kernels/fit_many/kernel_table.h"

namespace halfspace::detail {
namespace {

// Numbers of element i, from column `first` on.
template <int kDims>
Point<kDims, double> ElementAt(const kernels::FitJob& job, std::size_t i,
                               std::size_t first = 0) {
  Point<kDims, double> point;
  for (std::size_t k = 0; k < kDims; ++k) {
    point[k] = job.columns.doubles(first + k)[i * job.columns.stride];
  }
  return point;
}

// Writes bound_of(i) for every shape i.
template <int kDims, typename BoundOf>
kernels::FitTally FitEach(const kernels::FitJob& job, const BoundOf& bound_of) {
  kernels::FitTally tally;
  for (std::size_t i = 0; i < job.size; ++i) {
    const Aabo<kDims> bound = bound_of(i);
    if (bound == Aabo<kDims>::Everything()) tally.Count(1, i);
    for (std::size_t k = 0; k <= kDims; ++k) {
      float* const min = job.planes[k];
      float* const max = job.planes[kDims + 1 + k];
      if (min != nullptr) min[i] = bound.min[k];
      if (max != nullptr) max[i] = bound.max[k];
    }
  }
  return tally;
}

template <int kDims>
kernels::FitTally FitBoxes(const kernels::FitJob& job) {
  return FitEach<kDims>(job, [&](std::size_t i) {
    const Aabb<kDims, double> box = {ElementAt<kDims>(job, i),
                                     ElementAt<kDims>(job, i, kDims)};
    if (IsEmpty(box)) return Aabo<kDims>::Empty();
    bool is_inverted = false;
    bool is_number = true;
    for (std::size_t k = 0; k < kDims; ++k) {
      is_inverted |= box.min[k] > box.max[k];
      is_number &= box.min[k] == box.min[k] && box.max[k] == box.max[k];
    }
    if (!is_inverted) return BoundAabb(box);
    return is_number && job.inverted_is_empty ? Aabo<kDims>::Empty()
                                              : Aabo<kDims>::Everything();
  });
}

template <int kDims>
kernels::FitTally FitSpheres(const kernels::FitJob& job) {
  return FitEach<kDims>(job, [&](std::size_t i) {
    const Sphere<kDims, double> sphere = {
        ElementAt<kDims>(job, i),
        job.columns.doubles(kDims)[i * job.columns.stride]};
    if (!(sphere.radius >= 0)) return Aabo<kDims>::Everything();
    return BoundSphere(sphere);
  });
}

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

template <kernels::FitTally (*kFit)(const kernels::FitJob&)>
constexpr FitKernels kOneByOne = {kFit, kFit};

}  // namespace

const FitKernels* const kFitKernelsOfDoubles[4][3] = {
    {&kOneByOne<&FitBoxes<2>>, &kOneByOne<&FitBoxes<3>>,
     &kOneByOne<&FitBoxes<4>>},
    {&kOneByOne<&FitSpheres<2>>, &kOneByOne<&FitSpheres<3>>,
     &kOneByOne<&FitSpheres<4>>},
    {&kOneByOne<&FitTriangles<2>>, &kOneByOne<&FitTriangles<3>>,
     &kOneByOne<&FitTriangles<4>>},
    {&kOneByOne<&FitPointSets<2>>, &kOneByOne<&FitPointSets<3>>,
     &kOneByOne<&FitPointSets<4>>}};
static_assert(kFitBoxes == 0 && kFitSpheres == 1 && kFitTriangles == 2 &&
              kFitPointSets == 3);

}  // namespace halfspace::detail
