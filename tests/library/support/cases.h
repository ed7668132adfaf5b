// The ways to look at planes, for typed tests: each shape in 2, 3 and 4
// dimensions, and an octahedron's planes seen as a simplex or a box world, of
// floats and of doubles.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_CASES_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_CASES_H_

#include <gtest/gtest.h>

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

// A case: the planes in memory are those of `Stored`, and are queried as
// `View`.
template <typename TheView>
struct Whole {
  using Stored = TheView;
  using View = TheView;
  static View Seen(const Stored& stored) { return stored; }
  static typename View::Query Seen(const typename Stored::Query& query) {
    return query;
  }
};

template <int kDims>
struct AaboAsSimplex {
  using Stored = AaboView<kDims>;
  using View = SimplexView<kDims>;
  static View Seen(const Stored& stored) { return stored.simplex(); }
  static DownSimplex<kDims> Seen(const Aabo<kDims>& query) {
    return query.down();
  }
};

template <int kDims>
struct AaboAsAabb {
  using Stored = AaboView<kDims>;
  using View = AabbView<kDims>;
  static View Seen(const Stored& stored) { return stored.aabb(); }
  static Aabb<kDims> Seen(const Aabo<kDims>& query) { return query.aabb(); }
};

namespace internal {

template <typename T>
std::string NameOf(const char* shape, int dims, const char* seen_as = "") {
  const char* scalar = std::is_same_v<T, double> ? "Double" : "";
  return shape + std::to_string(dims) + scalar + seen_as;
}

}  // namespace internal

template <int kDims>
std::string NameOf(const Whole<SimplexView<kDims>>&) {
  return internal::NameOf<float>("Simplex", kDims);
}
template <int kDims, typename T>
std::string NameOf(const Whole<AabbView<kDims, T>>&) {
  return internal::NameOf<T>("Aabb", kDims);
}
template <int kDims>
std::string NameOf(const Whole<AaboView<kDims>>&) {
  return internal::NameOf<float>("Aabo", kDims);
}
template <int kDims>
std::string NameOf(const AaboAsSimplex<kDims>&) {
  return internal::NameOf<float>("Aabo", kDims, "AsSimplex");
}
template <int kDims>
std::string NameOf(const AaboAsAabb<kDims>&) {
  return internal::NameOf<float>("Aabo", kDims, "AsAabb");
}

// Whether this build leaves out 2 and 4 dimensions, as those do that take long
// for each: sanitizers, emulation. Of each file by itself (dims.h).
#if defined(HALFSPACE_TEST_ONLY_3D)
constexpr bool kTestsOnly3d = true;
#else
constexpr bool kTestsOnly3d = false;
#endif

template <int... kDims>
using CasesOf =
    ::testing::Types<Whole<SimplexView<kDims>>..., Whole<AabbView<kDims>>...,
                     Whole<AaboView<kDims>>..., AaboAsSimplex<kDims>...,
                     AaboAsAabb<kDims>..., Whole<AabbView<kDims, double>>...>;
using AllCases = std::conditional_t<kTestsOnly3d, CasesOf<3>, CasesOf<2, 3, 4>>;

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_CASES_H_
