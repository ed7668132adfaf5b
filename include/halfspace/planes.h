// Planes for writing: where the builders of fit_many.h store bounds.
//
//   planes              pointers
//   SimplexPlanes<D>    min[0 .. D]
//   AabbPlanes<D>       min[0 .. D-1], max[0 .. D-1]
//   AaboPlanes<D>       min[0 .. D], max[0 .. D]
//   DPlanes<D>          min and max of the D axis alone
//
// Each plane is `size` floats, or doubles, in the caller's memory, with the
// alignment of its type, and overlaps no other plane. An owning world returns
// its own by planes() (world.h). Nothing past element size - 1 is written. The
// read-only counterparts are the views of world.h. DPlanes have no counterpart:
// they complete the planes of an AABB world to those of an AABO world.
//
// Thread safety: plain values.
#ifndef HALFSPACE_PLANES_H_
#define HALFSPACE_PLANES_H_

#include <array>
#include <cstddef>

#include "halfspace/bounds.h"

namespace halfspace {

template <int kDims, typename T = float>
struct SimplexPlanes {
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
  using Scalar = T;
  static constexpr int kDimensions = kDims;

  std::array<T*, static_cast<std::size_t>(kDims) + 1> min{};
  std::size_t size = 0;
};

template <int kDims, typename T = float>
struct AabbPlanes {
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
  using Scalar = T;
  static constexpr int kDimensions = kDims;

  std::array<T*, static_cast<std::size_t>(kDims)> min{};
  std::array<T*, static_cast<std::size_t>(kDims)> max{};
  std::size_t size = 0;
};

template <int kDims, typename T = float>
struct AaboPlanes {
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
  using Scalar = T;
  static constexpr int kDimensions = kDims;

  std::array<T*, static_cast<std::size_t>(kDims) + 1> min{};
  std::array<T*, static_cast<std::size_t>(kDims) + 1> max{};
  std::size_t size = 0;
};

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
using SimplexPlanes4 = SimplexPlanes<4>;
using AabbPlanes2 = AabbPlanes<2>;
using AabbPlanes3 = AabbPlanes<3>;
using AabbPlanes4 = AabbPlanes<4>;
using AaboPlanes2 = AaboPlanes<2>;
using AaboPlanes3 = AaboPlanes<3>;
using AaboPlanes4 = AaboPlanes<4>;
using DPlanes2 = DPlanes<2>;
using DPlanes3 = DPlanes<3>;
using DPlanes4 = DPlanes<4>;

}  // namespace halfspace

#endif  // HALFSPACE_PLANES_H_
