// The ways to look at planes, for typed tests: each shape in 2, 3 and 4
// dimensions, and an octahedron's planes seen as a simplex or a box world.
#ifndef HALFSPACE_TESTS_LIBRARY_CASES_H_
#define HALFSPACE_TESTS_LIBRARY_CASES_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <tuple>

#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::testing {

template <typename T>
concept HasMinima = requires(T value) {
  value.min;
};
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

// The value of a query that plane p of a view is compared with.
template <typename View>
float& OpposingValue(typename View::Query& query, std::size_t p) {
  if constexpr (HasMaxima<View>) {
    if (!IsMinPlane<View>(p)) return query.min[p - kMinima<View>];
  }
  return query.max[p];
}

template <typename View>
const float*& PlaneOf(View& view, std::size_t p) {
  if constexpr (HasMaxima<View>) {
    if (!IsMinPlane<View>(p)) return view.max[p - kMinima<View>];
  }
  return view.min[p];
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

template <int kDims>
std::string NameOf(const Whole<SimplexView<kDims>>&) {
  return "Simplex" + std::to_string(kDims);
}
template <int kDims>
std::string NameOf(const Whole<AabbView<kDims>>&) {
  return "Aabb" + std::to_string(kDims);
}
template <int kDims>
std::string NameOf(const Whole<AaboView<kDims>>&) {
  return "Aabo" + std::to_string(kDims);
}
template <int kDims>
std::string NameOf(const AaboAsSimplex<kDims>&) {
  return "Aabo" + std::to_string(kDims) + "AsSimplex";
}
template <int kDims>
std::string NameOf(const AaboAsAabb<kDims>&) {
  return "Aabo" + std::to_string(kDims) + "AsAabb";
}

struct CaseNames {
  template <typename Case>
  static std::string GetName(int) {
    return NameOf(Case());
  }
};

using WholeCases =
    ::testing::Types<Whole<SimplexView2>, Whole<SimplexView3>,
                     Whole<SimplexView4>, Whole<AabbView2>, Whole<AabbView3>,
                     Whole<AabbView4>, Whole<AaboView2>, Whole<AaboView3>,
                     Whole<AaboView4>>;

using AllCases = ::testing::Types<
    Whole<SimplexView2>, Whole<SimplexView3>, Whole<SimplexView4>,
    Whole<AabbView2>, Whole<AabbView3>, Whole<AabbView4>, Whole<AaboView2>,
    Whole<AaboView3>, Whole<AaboView4>, AaboAsSimplex<2>, AaboAsSimplex<3>,
    AaboAsSimplex<4>, AaboAsAabb<2>, AaboAsAabb<3>, AaboAsAabb<4>>;

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_CASES_H_
