// Bounding volumes: bounding simplex, axis-aligned box (AABB) and axis-aligned
// bounding octahedron (AABO).
//
//   halfspace::Aabb3 box = {{0, 0, 0}, {1, 1, 1}};  // minima, maxima
//
// All of them are k-DOPs (discrete oriented polytopes): k half-spaces with
// fixed normals. A k-DOP stores the minimum and the maximum of an object on a
// few axes. In kDims dimensions these are the coordinate axes and one more, D
// (queries in 4 dimensions need a library built with -DHALFSPACE_DIMS="2;3;4"):
//
//   axis index   0 ... kDims - 1   X, Y, Z, W
//   axis index   kDims             D = -(X + Y + ...)
//
//   bound type (3D)            an object stores    compares in one test
//   UpSimplex   4-DOP          4 minima            4  against a DownSimplex
//   Aabb        6-DOP          3 minima, 3 maxima  6
//   Aabo        8-DOP          4 minima, 4 maxima  8
//
// The kDims + 1 axes sum to zero, so the kDims + 1 minima alone close a finite
// volume: the simplex.
//
// Use the builders of fit.h for the D axis. A sum in float rounds, and a D that
// is not rounded outward can reject objects that touch.
//
// Values are floats. Only boxes also exist with doubles, Aabb<3, double>, which
// need no rounding. D of doubles has to be rounded outward, so the builders
// return bounds of floats that enclose shapes of doubles, and a test of them
// reads half the bytes. RoundOutward (transform.h) does the same for a box.
//
// Units are the caller's. A plane with a NaN never rejects.
//
// Thread safety: plain values. Source: "The Bounding Simplex: A SIMD-Era
// Rejection Primitive" (simplices, AABO).
#ifndef HALFSPACE_BOUNDS_H_
#define HALFSPACE_BOUNDS_H_

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "halfspace/detail/cxx17.h"  // IWYU pragma: keep

namespace halfspace {

namespace detail {

template <std::size_t kCount, typename T>
constexpr std::array<T, kCount> Filled(T value) {
  std::array<T, kCount> values{};
  for (T& v : values) v = value;
  return values;
}

template <typename T>
inline constexpr bool kIsFloat32Or64 =
    std::is_same_v<T, float> || std::is_same_v<T, double>;

template <typename T>
inline constexpr T kMax = std::numeric_limits<T>::max();
template <typename T>
inline constexpr T kInf = std::numeric_limits<T>::infinity();

// Any number or infinity, but no NaN.
template <typename T>
constexpr bool IsNumber(T value) {
  return value <= kInf<T>;
}

template <typename Bound, typename = void>
inline constexpr bool HasMin = false;
template <typename Bound>
inline constexpr bool HasMin<Bound, std::void_t<decltype(Bound::min)>> = true;
template <typename Bound, typename = void>
inline constexpr bool HasMax = false;
template <typename Bound>
inline constexpr bool HasMax<Bound, std::void_t<decltype(Bound::max)>> = true;

// So that a call with another type than a bound fails to compile.
template <typename T>
using IfBound = std::enable_if_t<std::is_same_v<decltype(T::Everything()), T>>;

// The product of all lengths except that of axis `skipped`. 0 times infinity is
// 0.
template <typename Lengths>
constexpr auto ProductWithout(const Lengths& lengths, std::size_t skipped) {
  typename Lengths::value_type product = 1;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    if (k == skipped) continue;
    if (lengths[k] == 0) return lengths[k];
    product *= lengths[k];
  }
  return product;
}

// A simplex is the corner of a cube with edge `slack`, the sum of its maxima
// or of its negated minima.
template <typename T>
constexpr T CornerVolume(T slack, int dims) {
  if (slack <= 0) return 0;
  T volume = 1;
  for (int k = 1; k <= dims; ++k) volume *= slack / static_cast<T>(k);
  return volume;
}

}  // namespace detail

// All bound types are plain data: copy them, and set their members directly.
// Operators == and != compare the values: -0 equals 0, a NaN equals nothing.
//
// Every type has two special values:
//   Everything()  minima of -FLT_MAX, maxima of FLT_MAX (of doubles, DBL_MAX).
//                 These are finite values. No finite query rejects it. Builders
//                 return it for a shape that they cannot bound.
//   Empty()       minima of +infinity, maxima of -infinity. Every finite query,
//                 also Everything(), rejects it.

// A bounding simplex, the object side of the simplex test (S+ in the paper):
// the points p with p.axis[k] >= min[k] for every axis k.
template <int kDims>
struct UpSimplex {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = float;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims + 1;

  std::array<float, kAxes> min;

  static constexpr UpSimplex Everything() {
    return {detail::Filled<kAxes>(-detail::kMax<float>)};
  }
  static constexpr UpSimplex Empty() {
    return {detail::Filled<kAxes>(detail::kInf<float>)};
  }
};

// A bounding simplex, the query side of the simplex test (S- in the paper): the
// points p with p.axis[k] <= max[k] for every axis k.
template <int kDims>
struct DownSimplex {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = float;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims + 1;

  std::array<float, kAxes> max;

  static constexpr DownSimplex Everything() {
    return {detail::Filled<kAxes>(detail::kMax<float>)};
  }
  static constexpr DownSimplex Empty() {
    return {detail::Filled<kAxes>(-detail::kInf<float>)};
  }
};

// The axis-aligned bounding box. It has no D axis. Objects and queries are both
// boxes.
template <int kDims, typename T = float>
struct Aabb {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
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
};

// The axis-aligned bounding octahedron (AABO), an 8-DOP in 3D: a box with two
// opposite corners cut off. Its planes are the planes of both simplices, and
// include those of the box. Objects and queries are both octahedra.
template <int kDims>
struct Aabo {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  using Scalar = float;
  static constexpr int kDimensions = kDims;
  static constexpr std::size_t kAxes = kDims + 1;

  std::array<float, kAxes> min;
  std::array<float, kAxes> max;

  // Return the simplices and the box by copying their planes.
  constexpr UpSimplex<kDims> up() const { return {min}; }
  constexpr DownSimplex<kDims> down() const { return {max}; }
  constexpr Aabb<kDims> aabb() const {
    Aabb<kDims> box{};
    for (std::size_t k = 0; k < kDims; ++k) {
      box.min[k] = min[k];
      box.max[k] = max[k];
    }
    return box;
  }

  static constexpr Aabo Everything() {
    return {detail::Filled<kAxes>(-detail::kMax<float>),
            detail::Filled<kAxes>(detail::kMax<float>)};
  }
  static constexpr Aabo Empty() {
    return {detail::Filled<kAxes>(detail::kInf<float>),
            detail::Filled<kAxes>(-detail::kInf<float>)};
  }
};

// std::array's == is constexpr from C++20 on.
template <typename Bound, typename = detail::IfBound<Bound>>
constexpr bool operator==(const Bound& a, const Bound& b) {
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (detail::HasMin<Bound>) {
      if (!(a.min[k] == b.min[k])) return false;
    }
    if constexpr (detail::HasMax<Bound>) {
      if (!(a.max[k] == b.max[k])) return false;
    }
  }
  return true;
}
template <typename Bound, typename = detail::IfBound<Bound>>
constexpr bool operator!=(const Bound& a, const Bound& b) {
  return !(a == b);
}

// Returns whether the bound is empty: all its minima are at least FLT_MAX and
// all its maxima are at most -FLT_MAX (of doubles, DBL_MAX).
//
// Some engines initialize a box with minima of FLT_MAX and maxima of -FLT_MAX.
// IsEmpty, Intersection, Volume, HalfArea and every builder (fit.h,
// transform.h, fit_many.h) treat this value as Empty(). Where they return a
// bound for it, that bound is Empty(), with infinities.
//
// The calls of reject.h treat this value as numbers, both in an object and in a
// query. A bound that is limited on at least one side rejects it. Everything()
// keeps it. Push Empty() if that matters.
template <typename Bound, typename = detail::IfBound<Bound>>
constexpr bool IsEmpty(const Bound& bound) {
  constexpr auto kMax = detail::kMax<typename Bound::Scalar>;
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (detail::HasMin<Bound>) {
      if (!(bound.min[k] >= kMax)) return false;
    }
    if constexpr (detail::HasMax<Bound>) {
      if (!(bound.max[k] <= -kMax)) return false;
    }
  }
  return true;
}

// Returns the intersection of two bounds: the tighter of the two values in each
// plane. Nothing is rounded. Everything() changes nothing, and a NaN is no
// limit.
//
// Returns Empty() if one of the bounds is empty, or if a minimum of the result
// is greater than the maximum of its axis. Planes of different axes can also
// leave no point between them, for example if the box of X, Y and Z does not
// reach D. The call does not detect this. The result then encloses no point,
// but an object with this bound can survive a query.
template <typename Bound, typename = detail::IfBound<Bound>>
constexpr Bound Intersection(const Bound& a, const Bound& b) {
  Bound both = a;
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (detail::HasMin<Bound>) {
      const auto min = b.min[k];
      if (!(a.min[k] >= min) && detail::IsNumber(min)) both.min[k] = min;
    }
    if constexpr (detail::HasMax<Bound>) {
      const auto max = b.max[k];
      if (!(a.max[k] <= max) && detail::IsNumber(max)) both.max[k] = max;
    }
    if constexpr (detail::HasMin<Bound> && detail::HasMax<Bound>) {
      if (both.min[k] > both.max[k]) return Bound::Empty();
    }
  }
  return IsEmpty(both) ? Bound::Empty() : both;
}

// Volume and HalfArea are for cost heuristics. They are computed and rounded
// in the type of the values. The result is
// - 0 if a minimum is greater than the maximum of its axis, if a simplex has no
//   point, and for Empty(),
// - infinity on overflow, and for Everything(),
// - NaN if a plane that the result depends on is NaN.
// There are none for an Aabo: use its aabb().
//
// Returns the volume (in 2 dimensions the area).
template <int kDims>
constexpr float Volume(const UpSimplex<kDims>& bound) {
  float slack = 0;
  for (float min : bound.min) slack -= min;
  return detail::CornerVolume(slack, kDims);
}
template <int kDims>
constexpr float Volume(const DownSimplex<kDims>& bound) {
  float slack = 0;
  for (float max : bound.max) slack += max;
  return detail::CornerVolume(slack, kDims);
}
template <int kDims, typename T>
constexpr T Volume(const Aabb<kDims, T>& bound) {
  std::array<T, Aabb<kDims, T>::kAxes> lengths{};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    lengths[k] = bound.max[k] - bound.min[k];
    if (lengths[k] < 0) return 0;
  }
  return detail::ProductWithout(lengths, lengths.size());
}

// Returns half the surface area, which the surface area heuristic (SAH) of a
// BVH compares. In 2 dimensions this is half the perimeter. In 4 dimensions it
// is half the total volume of the 8 boxes that bound it.
template <int kDims, typename T>
constexpr T HalfArea(const Aabb<kDims, T>& bound) {
  std::array<T, Aabb<kDims, T>::kAxes> lengths{};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    lengths[k] = bound.max[k] - bound.min[k];
    if (lengths[k] < 0) return 0;
  }
  T area = 0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    area += detail::ProductWithout(lengths, k);
  }
  return area;
}

using UpSimplex2 = UpSimplex<2>;
using UpSimplex3 = UpSimplex<3>;
using DownSimplex2 = DownSimplex<2>;
using DownSimplex3 = DownSimplex<3>;
using Aabb2 = Aabb<2>;
using Aabb3 = Aabb<3>;
using Aabo2 = Aabo<2>;
using Aabo3 = Aabo<3>;

}  // namespace halfspace

#endif  // HALFSPACE_BOUNDS_H_
