// Planes: the output arrays of the builders in fit_many.h.
//
//   planes              pointers
//   SimplexPlanes<D>    min[0 .. D]
//   AabbPlanes<D>       min[0 .. D-1], max[0 .. D-1]
//   AaboPlanes<D>       min[0 .. D], max[0 .. D]
//   DPlanes<D>          min and max of the D axis alone
//
// Each pointer is the start of an array of `size` floats in the caller's
// memory. The array must be aligned for its element type and must not overlap
// another plane. A builder writes elements 0 ... size - 1 and nothing else. An
// owning world returns its own planes from planes() (world.h).
//
// The views of world.h are the read-only versions of these types. DPlanes have
// no read-only version: they add the D axis to the planes of an AABB world,
// which makes the planes of an AABO world.
//
// Thread safety: plain values.
#ifndef HALFSPACE_PLANES_H_
#define HALFSPACE_PLANES_H_

#include <array>
#include <cstddef>

#include "halfspace/bounds.h"

namespace halfspace {

// The minima of kDims + 1 axes.
template <int kDims>
struct SimplexPlanes {
  using Scalar = float;
  static constexpr int kDimensions = kDims;

  std::array<float*, static_cast<std::size_t>(kDims) + 1> min{};
  std::size_t size = 0;
};

// The minima and maxima of kDims axes.
template <int kDims, typename T = float>
struct AabbPlanes {
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
  using Scalar = T;
  static constexpr int kDimensions = kDims;

  std::array<T*, static_cast<std::size_t>(kDims)> min{};
  std::array<T*, static_cast<std::size_t>(kDims)> max{};
  std::size_t size = 0;
};

// The minima and maxima of kDims + 1 axes.
template <int kDims>
struct AaboPlanes {
  using Scalar = float;
  static constexpr int kDimensions = kDims;

  std::array<float*, static_cast<std::size_t>(kDims) + 1> min{};
  std::array<float*, static_cast<std::size_t>(kDims) + 1> max{};
  std::size_t size = 0;
};

// The minimum and the maximum of the D axis.
template <int kDims>
struct DPlanes {
  using Scalar = float;
  static constexpr int kDimensions = kDims;

  float* min = nullptr;
  float* max = nullptr;
  std::size_t size = 0;
};

using SimplexPlanes2 = SimplexPlanes<2>;
using SimplexPlanes3 = SimplexPlanes<3>;
using AabbPlanes2 = AabbPlanes<2>;
using AabbPlanes3 = AabbPlanes<3>;
using AaboPlanes2 = AaboPlanes<2>;
using AaboPlanes3 = AaboPlanes<3>;
using DPlanes2 = DPlanes<2>;
using DPlanes3 = DPlanes<3>;

}  // namespace halfspace

#endif  // HALFSPACE_PLANES_H_
