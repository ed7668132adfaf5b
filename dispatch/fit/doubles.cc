// Bounds of many shapes of doubles: those of fit.h, one after the other.
#include <cstddef>
#include <cstdint>

#include "halfspace/bounds.h"
#include "halfspace/detail/fit_many.h"
#include "halfspace/fit.h"
#include "halfspace/shapes.h"
#include "kernels/fit_many/kernel_table.h"

namespace halfspace::detail {
namespace {

using kernels::FitJob;
using kernels::FitTally;

// Numbers of element i, from column `first` on.
template <int kDims>
Point<kDims, double> ElementAt(const FitJob& job, std::size_t i,
                               std::size_t first = 0) {
  Point<kDims, double> point;
  for (std::size_t k = 0; k < kDims; ++k) {
    point[k] = job.columns.doubles(first + k)[i * job.columns.stride];
  }
  return point;
}

template <int kDims>
Aabo<kDims> BoxAt(const FitJob& job, std::size_t i) {
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
}

template <int kDims>
Aabo<kDims> SphereAt(const FitJob& job, std::size_t i) {
  const double radius = job.columns.doubles(kDims)[i * job.columns.stride];
  if (!(radius >= 0)) return Aabo<kDims>::Everything();
  return BoundSphere(Sphere<kDims, double>{ElementAt<kDims>(job, i), radius});
}

template <int kDims>
Aabo<kDims> TriangleAt(const FitJob& job, std::size_t i) {
  const std::uint32_t* const corners = job.indices + 3 * i;
  for (std::size_t c = 0; c < 3; ++c) {
    if (corners[c] >= job.columns.size) return Aabo<kDims>::Everything();
  }
  return BoundTriangle(Triangle<kDims, double>{
      ElementAt<kDims>(job, corners[0]), ElementAt<kDims>(job, corners[1]),
      ElementAt<kDims>(job, corners[2])});
}

template <int kDims>
Aabo<kDims> PointSetAt(const FitJob& job, std::size_t i) {
  const std::size_t begin = i == 0 ? 0 : job.ends[i - 1];
  const std::size_t end = job.ends[i];
  if (begin > end || end > job.columns.size) return Aabo<kDims>::Everything();
  if (begin == end) return Aabo<kDims>::Empty();
  // Columns of points have a stride only where they are structures.
  if (const std::size_t stride = job.columns.stride; stride != 1) {
    return BoundPoints(Points<kDims, double>{
        job.columns.doubles(0) + begin * stride, end - begin, stride});
  }
  PointsSoa<kDims, double> points;
  points.count = end - begin;
  for (std::size_t k = 0; k < kDims; ++k) {
    points.coords[k] = job.columns.doubles(k) + begin;
  }
  return BoundPoints(points);
}

// Writes the bound of every shape.
template <int kDims, Aabo<kDims> (*kBoundAt)(const FitJob&, std::size_t)>
FitTally FitEach(const FitJob& job) {
  FitTally tally;
  for (std::size_t i = 0; i < job.size; ++i) {
    const Aabo<kDims> bound = kBoundAt(job, i);
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

template <int kDims, Aabo<kDims> (*kBoundAt)(const FitJob&, std::size_t)>
constexpr FitKernels kEach = {&FitEach<kDims, kBoundAt>};

}  // namespace

const FitKernels* const kFitOfDoubles[4][3] = {
    {&kEach<2, &BoxAt<2>>, &kEach<3, &BoxAt<3>>, &kEach<4, &BoxAt<4>>},
    {&kEach<2, &SphereAt<2>>, &kEach<3, &SphereAt<3>>, &kEach<4, &SphereAt<4>>},
    {&kEach<2, &TriangleAt<2>>, &kEach<3, &TriangleAt<3>>,
     &kEach<4, &TriangleAt<4>>},
    {&kEach<2, &PointSetAt<2>>, &kEach<3, &PointSetAt<3>>,
     &kEach<4, &PointSetAt<4>>}};

}  // namespace halfspace::detail
