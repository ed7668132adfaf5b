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
// Engines initialise boxes to minima of +FLT_MAX and maxima of -FLT_MAX (of
// doubles, DBL_MAX). A bound with these on all planes is Empty(), too: to
// IsEmpty, to Intersection and the measures, and to every builder and bound of
// bounds, whose results have infinities instead. To a scan they are numbers: an
// object stored so, or such a query, is rejected by whatever has a limit on any
// plane, but kept by Everything(). Push Empty() where that matters.
//
// Thread safety: plain values. Source: "The Bounding Simplex: A SIMD-Era
// Rejection Primitive" (simplices, AABO).
#ifndef HALFSPACE_BOUNDS_H_
#define HALFSPACE_BOUNDS_H_

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace halfspace {

namespace detail {

template <std::size_t kCount, typename T>
constexpr std::array<T, kCount> Filled(T value) {
  std::array<T, kCount> values{};
  for (T& v : values) v = value;
  return values;
}

// std::array's == is constexpr from C++20 on.
template <typename T, std::size_t kCount>
constexpr bool Equal(const std::array<T, kCount>& a,
                     const std::array<T, kCount>& b) {
  for (std::size_t i = 0; i < kCount; ++i) {
    if (!(a[i] == b[i])) return false;
  }
  return true;
}

template <typename T>
inline constexpr bool kIsFloat32Or64 =
    std::is_same_v<T, float> || std::is_same_v<T, double>;

template <typename T>
inline constexpr T kMax = std::numeric_limits<T>::max();
template <typename T>
inline constexpr T kInf = std::numeric_limits<T>::infinity();

template <typename Values>
constexpr bool AreEmptyMinima(const Values& min) {
  for (auto v : min) {
    if (!(v >= kMax<decltype(v)>)) return false;
  }
  return true;
}
template <typename Values>
constexpr bool AreEmptyMaxima(const Values& max) {
  for (auto v : max) {
    if (!(v <= -kMax<decltype(v)>)) return false;
  }
  return true;
}

// Any number or infinity, but no NaN.
template <typename T>
constexpr bool IsNumber(T value) {
  return value <= kInf<T>;
}

// Of two limits the one that leaves less. A NaN is no limit.
template <typename Values>
constexpr Values TighterMinima(Values a, const Values& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(a[k] >= b[k]) && IsNumber(b[k])) a[k] = b[k];
  }
  return a;
}
template <typename Values>
constexpr Values TighterMaxima(Values a, const Values& b) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    if (!(a[k] <= b[k]) && IsNumber(b[k])) a[k] = b[k];
  }
  return a;
}

// `bound`, or Empty() if it has no point for the planes of one axis.
template <typename Bound>
constexpr Bound EmptyIfInverted(const Bound& bound) {
  for (std::size_t k = 0; k < bound.min.size(); ++k) {
    if (bound.min[k] > bound.max[k]) return Bound::Empty();
  }
  return bound;
}

// The product of all lengths but that of axis `skipped`; 0 times anything is 0.
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

// A simplex whose planes are `slack` apart is the corner of a cube with that
// edge.
template <typename T>
constexpr T CornerVolume(T slack, int dims) {
  if (slack <= 0) return 0;
  T volume = 1;
  for (int k = 1; k <= dims; ++k) volume *= slack / static_cast<T>(k);
  return volume;
}

}  // namespace detail

// The object side of the simplex test, S+: { p : p.axis[k] >= min[k] }.
template <int kDims, typename T = float>
struct UpSimplex {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
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
  friend constexpr bool operator==(const UpSimplex& a, const UpSimplex& b) {
    return detail::Equal(a.min, b.min);
  }
  friend constexpr bool operator!=(const UpSimplex& a, const UpSimplex& b) {
    return !(a == b);
  }
};

// The query side of the simplex test, S-: { p : p.axis[k] <= max[k] }.
template <int kDims, typename T = float>
struct DownSimplex {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
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
  friend constexpr bool operator==(const DownSimplex& a, const DownSimplex& b) {
    return detail::Equal(a.max, b.max);
  }
  friend constexpr bool operator!=(const DownSimplex& a, const DownSimplex& b) {
    return !(a == b);
  }
};

// The axis-aligned bounding box; no D axis. Both sides of a test are boxes.
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
  friend constexpr bool operator==(const Aabb& a, const Aabb& b) {
    return detail::Equal(a.min, b.min) && detail::Equal(a.max, b.max);
  }
  friend constexpr bool operator!=(const Aabb& a, const Aabb& b) {
    return !(a == b);
  }
};

// The axis-aligned bounding octahedron: both simplices, hence also the box.
template <int kDims, typename T = float>
struct Aabo {
  static_assert(kDims >= 2 && kDims <= 4, "2, 3 or 4 dimensions");
  static_assert(detail::kIsFloat32Or64<T>, "floats or doubles");
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
  friend constexpr bool operator==(const Aabo& a, const Aabo& b) {
    return detail::Equal(a.min, b.min) && detail::Equal(a.max, b.max);
  }
  friend constexpr bool operator!=(const Aabo& a, const Aabo& b) {
    return !(a == b);
  }
};

// Whether the bound is Empty(), or what engines take for it; see above.
template <int kDims, typename T>
constexpr bool IsEmpty(const UpSimplex<kDims, T>& bound) {
  return detail::AreEmptyMinima(bound.min);
}
template <int kDims, typename T>
constexpr bool IsEmpty(const DownSimplex<kDims, T>& bound) {
  return detail::AreEmptyMaxima(bound.max);
}
template <int kDims, typename T>
constexpr bool IsEmpty(const Aabb<kDims, T>& bound) {
  return detail::AreEmptyMinima(bound.min) && detail::AreEmptyMaxima(bound.max);
}
template <int kDims, typename T>
constexpr bool IsEmpty(const Aabo<kDims, T>& bound) {
  return detail::AreEmptyMinima(bound.min) && detail::AreEmptyMaxima(bound.max);
}

// What is inside both bounds: of each plane the tighter one, so nothing is
// rounded. Everything() changes nothing, and a NaN is no limit. Empty() if a
// minimum comes to lie above the maximum of its axis, as if one of the two is
// Empty(). Planes of different axes that leave no point between them, such as a
// D that the box does not reach, stay as they are: such a bound encloses
// nothing, but a scan may keep it.
template <int kDims, typename T>
constexpr UpSimplex<kDims, T> Intersection(const UpSimplex<kDims, T>& a,
                                           const UpSimplex<kDims, T>& b) {
  const UpSimplex<kDims, T> both{detail::TighterMinima(a.min, b.min)};
  return IsEmpty(both) ? UpSimplex<kDims, T>::Empty() : both;
}
template <int kDims, typename T>
constexpr DownSimplex<kDims, T> Intersection(const DownSimplex<kDims, T>& a,
                                             const DownSimplex<kDims, T>& b) {
  const DownSimplex<kDims, T> both{detail::TighterMaxima(a.max, b.max)};
  return IsEmpty(both) ? DownSimplex<kDims, T>::Empty() : both;
}
template <int kDims, typename T>
constexpr Aabb<kDims, T> Intersection(const Aabb<kDims, T>& a,
                                      const Aabb<kDims, T>& b) {
  return detail::EmptyIfInverted(
      Aabb<kDims, T>{detail::TighterMinima(a.min, b.min),
                     detail::TighterMaxima(a.max, b.max)});
}
template <int kDims, typename T>
constexpr Aabo<kDims, T> Intersection(const Aabo<kDims, T>& a,
                                      const Aabo<kDims, T>& b) {
  return detail::EmptyIfInverted(
      Aabo<kDims, T>{detail::TighterMinima(a.min, b.min),
                     detail::TighterMaxima(a.max, b.max)});
}

// Measures, to choose between bounds by: computed and rounded as T. 0 if a
// minimum is above the maximum of its axis, or, of a simplex, if it has no
// point: so of Empty(). Infinite where they overflow, as of Everything(). NaN
// with a NaN in a plane that counts. Of an Aabo, take that of its aabb().
template <int kDims, typename T>
constexpr T Volume(const UpSimplex<kDims, T>& bound) {
  T slack = 0;
  for (T min : bound.min) slack -= min;
  return detail::CornerVolume(slack, kDims);
}
template <int kDims, typename T>
constexpr T Volume(const DownSimplex<kDims, T>& bound) {
  T slack = 0;
  for (T max : bound.max) slack += max;
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

// Half the surface, which the surface area heuristic compares: in 2 dimensions
// half the circumference, in 4 half the volume of the 8 boxes around it.
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
