// The length of D's normal, sqrt(kDims), and never less.
#ifndef HALFSPACE_KERNELS_FIT_MANY_ROOT_OF_DIMS_H_
#define HALFSPACE_KERNELS_FIT_MANY_ROOT_OF_DIMS_H_

namespace halfspace::kernels {

// The least double that is not too small. sqrt(3) alone rounds *down*, in float
// as in double, and a radius times that would cut into the sphere.
template <int kDims>
inline constexpr double kRootOfDims = 2.0;
template <>
inline constexpr double kRootOfDims<2> = 0x1.6a09e667f3bcdp+0;
template <>
inline constexpr double kRootOfDims<3> = 0x1.bb67ae8584cabp+0;

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_FIT_MANY_ROOT_OF_DIMS_H_
