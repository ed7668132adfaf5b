// The rows of flat_cases.h, for every kind of world.
#include <cstddef>
#include <type_traits>
#include <vector>

#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

template <typename View>
FlatCase RowOf() {
  using Scalar = ScalarOf<View>;
  return {NameOf(View()), detail::kLayoutOf<typename View::Bound>,
          std::is_same_v<Scalar, double>,
          [](const PlanePointers& planes, std::size_t size) {
            View view;
            for (std::size_t p = 0; p < kPlanes<View>; ++p) {
              PlaneOf(view, p) = static_cast<const Scalar*>(planes[p]);
            }
            view.size = size;
            return AnyWorld(view);
          }};
}

template <int... kDims>
std::vector<FlatCase> RowsOf() {
  return {RowOf<SimplexView<kDims>>()..., RowOf<AabbView<kDims>>()...,
          RowOf<AaboView<kDims>>()..., RowOf<AabbView<kDims, double>>()...};
}

}  // namespace

std::vector<FlatCase> AllFlatRows() {
  if constexpr (kTestsOnly3d) {
    return RowsOf<3>();
  } else {
    return RowsOf<2, 3, 4>();
  }
}

}  // namespace halfspace::testing
