// The bounding volumes: simplex, axis-aligned box, axis-aligned octahedron.
//
// All are discrete oriented polytopes (k-DOPs): sets of k half-spaces with
// fixed normals, stored as the least and greatest projections of an object on a
// few axes. In kDims dimensions the axes are the kDims coordinate axes and D =
// -(X + Y + ...). These sum to zero and positively span space, so kDims + 1
// half-spaces close a finite volume.
//
//   axis index   0 ... kDims - 1   X, Y, Z, W
//   axis index   kDims             D = -(X + Y + ...)
//
//   shape (3D)                 an object stores    compares in one test
//   UpSimplex   4-DOP          4 minima            4  against a DownSimplex
//   Aabb        6-DOP          3 minima, 3 maxima  6
//   Aabo        8-DOP          4 minima, 4 maxima  8
//
// An Aabo is an Aabb with two opposite corners cut off. Its planes contain
// those of both simplices and of the box; up(), down() and aabb() return them
// without computing anything.
//
// Units are the caller's. All values are plain data: copy them, fill them by
// hand, compare them with == (as floats: -0 equals 0, a NaN equals nothing).
// Use the builders of fit.h for the D axis: a sum rounds, and a D that is not
// rounded outward separates objects that touch.
//
// Values are floats, or doubles, as in Aabb<3, double>. The two precisions do
// not mix. Builders return floats; the D axis of a bound of doubles is summed,
// and rounded outward, by the caller.
//
// Two special values exist for every type:
//   Everything()  -/+ the largest finite value: never rejected by a finite
//                 query, nor by another Everything. Builders return it for what
//                 they cannot bound.
//   Empty()       +inf / -inf: rejected by every finite query and Everything.
// A plane with a NaN never rejects.
//
// Thread safety: plain values. Source: "The Bounding Simplex: A SIMD-Era
// Rejection Primitive" (simplices, AABO).
#ifndef HALFSPACE_BOUNDS_H_
#define HALFSPACE_BOUNDS_H_

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>

namespace halfspace {

namespace detail {

template <std::size_t kCount, typename T>
constexpr std::array<T, kCount> Filled(T value) {
  std::array<T, kCount> values{};
  for (T& v : values) v = value;
  return values;
}

template <typename T>
concept Float32Or64 = std::same_as<T, float> || std::same_as<T, double>;

template <Float32Or64 T>
inline constexpr T kMax = std::numeric_limits<T>::max();
template <Float32Or64 T>
inline constexpr T kInf = std::numeric_limits<T>::infinity();

}  // namespace detail

// The object side of the simplex test, S+: { p : p.axis[k] >= min[k] }.
template <int kDims, detail::Float32Or64 T = float>
struct UpSimplex {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = T;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims + 1;

  std::array<T, kAxes> min;

  static constexpr UpSimplex Everything() {
    return {detail::Filled<kAxes>(-detail::kMax<T>)};
  }
  static constexpr UpSimplex Empty() {
    return {detail::Filled<kAxes>(detail::kInf<T>)};
  }
  friend constexpr bool operator==(const UpSimplex&,
                                   const UpSimplex&) = default;
};

// The query side of the simplex test, S-: { p : p.axis[k] <= max[k] }.
template <int kDims, detail::Float32Or64 T = float>
struct DownSimplex {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = T;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims + 1;

  std::array<T, kAxes> max;

  static constexpr DownSimplex Everything() {
    return {detail::Filled<kAxes>(detail::kMax<T>)};
  }
  static constexpr DownSimplex Empty() {
    return {detail::Filled<kAxes>(-detail::kInf<T>)};
  }
  friend constexpr bool operator==(const DownSimplex&,
                                   const DownSimplex&) = default;
};

// The axis-aligned bounding box; no D axis. Both sides of a test are boxes.
template <int kDims, detail::Float32Or64 T = float>
struct Aabb {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = T;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims;

  std::array<T, kAxes> min;
  std::array<T, kAxes> max;

  static constexpr Aabb Everything() {
    return {detail::Filled<kAxes>(-detail::kMax<T>),
            detail::Filled<kAxes>(detail::kMax<T>)};
  }
  static constexpr Aabb Empty() {
    return {detail::Filled<kAxes>(detail::kInf<T>),
            detail::Filled<kAxes>(-detail::kInf<T>)};
  }
  friend constexpr bool operator==(const Aabb&, const Aabb&) = default;
};

// The axis-aligned bounding octahedron: both simplices, hence also the box.
template <int kDims, detail::Float32Or64 T = float>
struct Aabo {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = T;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims + 1;

  std::array<T, kAxes> min;
  std::array<T, kAxes> max;

  constexpr UpSimplex<kDims, T> up() const { return {min}; }
  constexpr DownSimplex<kDims, T> down() const { return {max}; }
  constexpr Aabb<kDims, T> aabb() const {
    Aabb<kDims, T> box{};
    for (std::size_t k = 0; k < kDims; ++k) {
      box.min[k] = min[k];
      box.max[k] = max[k];
    }
    return box;
  }

  static constexpr Aabo Everything() {
    return {detail::Filled<kAxes>(-detail::kMax<T>),
            detail::Filled<kAxes>(detail::kMax<T>)};
  }
  static constexpr Aabo Empty() {
    return {detail::Filled<kAxes>(detail::kInf<T>),
            detail::Filled<kAxes>(-detail::kInf<T>)};
  }
  friend constexpr bool operator==(const Aabo&, const Aabo&) = default;
};

using UpSimplex2 = UpSimplex<2>;
using UpSimplex3 = UpSimplex<3>;
using UpSimplex4 = UpSimplex<4>;
using DownSimplex2 = DownSimplex<2>;
using DownSimplex3 = DownSimplex<3>;
using DownSimplex4 = DownSimplex<4>;
using Aabb2 = Aabb<2>;
using Aabb3 = Aabb<3>;
using Aabb4 = Aabb<4>;
using Aabo2 = Aabo<2>;
using Aabo3 = Aabo<3>;
using Aabo4 = Aabo<4>;

}  // namespace halfspace

#endif  // HALFSPACE_BOUNDS_H_
