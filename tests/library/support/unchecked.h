// The calls of kernels.h, by the type of a view.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_UNCHECKED_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_UNCHECKED_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "halfspace/kernels.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

namespace internal {

// The one of 2, 3 and 4 dimensions.
template <int kDims, typename Entry>
const Entry& OfDims(const Entry& of2, const Entry& of3, const Entry& of4) {
  return kDims == 2 ? of2 : kDims == 3 ? of3 : of4;
}

template <int kDims, typename T>
const auto& KernelsFor(const Kernels<T>& kernels, const AabbView<kDims, T>&) {
  return OfDims<kDims>(kernels.boxes2, kernels.boxes3, kernels.boxes4);
}
template <int kDims>
const auto& KernelsFor(const Kernels<float>& kernels,
                       const SimplexView<kDims>&) {
  return OfDims<kDims>(kernels.simplices2, kernels.simplices3,
                       kernels.simplices4);
}
template <int kDims>
const auto& KernelsFor(const Kernels<float>& kernels, const AaboView<kDims>&) {
  return OfDims<kDims>(kernels.octahedra2, kernels.octahedra3,
                       kernels.octahedra4);
}

// The pointers to a view's planes, and the values of its queries.
template <typename View>
auto PlanesOf(View view) {
  std::array<const ScalarOf<View>*, kPlanes<View>> planes;
  for (std::size_t p = 0; p < planes.size(); ++p) planes[p] = PlaneOf(view, p);
  return planes;
}
template <typename Query>
const auto* ValuesOf(const Query* queries) {
  return reinterpret_cast<const typename Query::Scalar*>(queries);
}

}  // namespace internal

// Whether kernels.h has calls for such a world: for any view of floats or
// doubles.
template <typename AnyWorld>
concept HasKernels = requires(const AnyWorld& world) {
  internal::KernelsFor(Kernels<ScalarOf<AnyWorld>>(), world);
};

template <typename View>
void SurvivorMaskUnchecked(const View& view, const typename View::Query& query,
                           std::span<std::uint64_t> mask, Target target) {
  const auto planes = internal::PlanesOf(view);
  internal::KernelsFor(KernelsOf<ScalarOf<View>>(target), view)
      .one(planes.data(), view.size, internal::ValuesOf(&query), mask.data());
}

template <typename View>
void SurvivorMasksUnchecked(const View& view,
                            std::span<const typename View::Query> queries,
                            std::span<std::uint64_t> rows, Target target) {
  const auto planes = internal::PlanesOf(view);
  internal::KernelsFor(KernelsOf<ScalarOf<View>>(target), view)
      .several(planes.data(), view.size, internal::ValuesOf(queries.data()),
               queries.size(), rows.data());
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_UNCHECKED_H_
