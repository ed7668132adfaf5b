// The planes of views, and the kinds of views for tests: each shape in 2, 3 and
// 4 dimensions, of floats and of doubles.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_CASES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_CASES_H_

#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>

#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::testing {

template <typename T>
concept HasMaxima = requires(T value) {
  value.max;
};

// Planes of a view: its minima, then its maxima.
template <typename View>
inline constexpr std::size_t kMinima = std::tuple_size_v<decltype(View::min)>;
template <typename View>
inline constexpr std::size_t kPlanes =
    HasMaxima<View> ? 2 * kMinima<View> : kMinima<View>;

template <typename View>
constexpr bool IsMinPlane(std::size_t p) {
  return p < kMinima<View>;
}

template <typename View>
using ScalarOf = typename View::Bound::Scalar;

template <typename View>
const ScalarOf<View>*& PlaneOf(View& view, std::size_t p) {
  if constexpr (HasMaxima<View>) {
    if (!IsMinPlane<View>(p)) return view.max[p - kMinima<View>];
  }
  return view.min[p];
}

// Which value of a query plane p is compared with.
inline std::size_t OpposingValue(const detail::PlaneLayout& layout,
                                 std::size_t p) {
  return p < layout.axes ? layout.first_max + p : p - layout.axes;
}

template <typename View>
std::string NameOf(const View&) {
  constexpr int kDims = View::Bound::kDimensions;
  constexpr bool kIsDouble = std::is_same_v<ScalarOf<View>, double>;
  return (!HasMaxima<View>         ? "Simplex"
          : kMinima<View> == kDims ? "Aabb"
                                   : "Aabo") +
         std::to_string(kDims) + (kIsDouble ? "Double" : "");
}

// Whether this build leaves out 2 and 4 dimensions, as those do that take long
// for each: sanitizers, emulation. Of each file by itself (dims.h).
#if defined(HALFSPACE_TEST_ONLY_3D)
constexpr bool kTestsOnly3d = true;
#else
constexpr bool kTestsOnly3d = false;
#endif

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_CASES_H_
