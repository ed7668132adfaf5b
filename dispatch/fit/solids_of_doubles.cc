// Bounds of many boxes and spheres of doubles.
#include <cstddef>

#include "dispatch/fit/one_by_one.h"
#include "halfspace/fit.h"

namespace halfspace::detail {
namespace {

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

}  // namespace

const FitKernels* const kFitSolidsOfDoubles[2][3] = {
    {&kOneByOne<&FitBoxes<2>>, &kOneByOne<&FitBoxes<3>>,
     &kOneByOne<&FitBoxes<4>>},
    {&kOneByOne<&FitSpheres<2>>, &kOneByOne<&FitSpheres<3>>,
     &kOneByOne<&FitSpheres<4>>}};

}  // namespace halfspace::detail
