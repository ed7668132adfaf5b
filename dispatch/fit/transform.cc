// Bounds of bounds. Everything is written for minima alone: the maxima of a
// bound are the negated minima of the mirrored shape.
#include "halfspace/transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "dispatch/errors/error.h"
#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/outward.h"
#include "dispatch/fit/instantiate.h"
#include "halfspace/detail/plane_arrays.h"
#include "kernels/fit_many/root_of_dims.h"

namespace halfspace {
namespace {

using detail::HasMax;
using detail::HasMin;
using dispatch::Build;
using dispatch::RoundDown;
using dispatch::SumExactly;

constexpr float kUnbounded = -detail::kMax<float>;  // as a minimum
constexpr float kMostMagnitude = 0x1p126f;

// False for NaN too.
bool CanBeBounded(float minimum) {
  return std::fabs(minimum) <= kMostMagnitude;
}

bool IsValid(float minimum) {
  return minimum == kUnbounded || CanBeBounded(minimum);
}

template <std::size_t kCount>
std::array<float, kCount> Negated(std::array<float, kCount> values) {
  for (float& value : values) value = -value;
  return values;
}

// Replaces each minimum of the bound, and each mirrored maximum, by
// change(minimum, axis, sign), where the sign is -1 for the mirrored. Nothing
// if a value cannot be bounded. Not inlined: a move takes 10 ns more if it is.
template <typename Bound, typename Change>
HALFSPACE_NOINLINE std::optional<Bound> TryChange(const Bound& bound,
                                                  const Change& change) {
  bool ok = true;
  const auto changed = [&](float minimum, std::size_t axis, double sign) {
    if (minimum == kUnbounded) return kUnbounded;
    const float result = change(minimum, axis, sign);
    ok &= CanBeBounded(minimum) && IsValid(result);
    return result;
  };
  Bound result;
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (HasMin<Bound>) {
      result.min[k] = changed(bound.min[k], k, 1.0);
    }
    if constexpr (HasMax<Bound>) {
      result.max[k] = -changed(-bound.max[k], k, -1.0);
    }
  }
  if (!ok) return std::nullopt;
  return result;
}

// In the default mode, which the callers set. Nothing stays nothing, whatever
// the change; by an amount that is not finite, all else becomes everything.
template <typename Bound, typename Change>
std::optional<Bound> ChangePlanes(const Bound& bound, bool is_finite,
                                  const Change& change) {
  if (IsEmpty(bound)) return Bound::Empty();
  if (!is_finite) return std::nullopt;
  return TryChange(bound, change);
}

template <typename Bound>
constexpr bool IsD(std::size_t axis) {
  static_assert(Bound::kAxes >= Bound::kDimensions, "slot k is axis k");
  return axis == static_cast<std::size_t>(Bound::kDimensions);
}

template <typename Coords>
bool IsFinite(const Coords& point) {
  return std::all_of(point.begin(), point.end(),
                     [](float x) { return std::isfinite(x); });
}

// A minimum, or mirrored maximum, after all points moved by `by`.
template <typename Bound, std::size_t kDims>
float Moved(float minimum, std::size_t axis, double sign,
            const std::array<float, kDims>& by) {
  if (!IsD<Bound>(axis)) {
    return RoundDown(
        SumExactly(std::array<double, 2>{minimum, sign * by[axis]}));
  }
  std::array<double, kDims + 1> terms;
  for (std::size_t k = 0; k < kDims; ++k) terms[k] = -sign * by[k];
  terms[kDims] = minimum;
  return RoundDown(SumExactly(terms));
}

// The opposing simplex' minima, mirrored: on each axis, minus the sum of the
// others, since all axes sum to zero. Not inlined, as TryChange.
template <std::size_t kAxes>
HALFSPACE_NOINLINE std::optional<std::array<float, kAxes>> TryOpposing(
    const std::array<float, kAxes>& minima) {
  std::array<double, kAxes> terms;
  std::copy(minima.begin(), minima.end(), terms.begin());
  bool is_bounded = true;
  for (float minimum : minima) {
    if (minimum == kUnbounded) {
      is_bounded = false;
    } else if (!CanBeBounded(minimum)) {
      return std::nullopt;
    }
  }
  if (is_bounded && SumExactly(terms).value > 0.0) {
    dispatch::ThrowInvalid("Circumscribe", "simplex",
                           "planes that sum to 0 or less",
                           "a simplex that contains no point");
  }
  std::array<float, kAxes> opposing;
  for (std::size_t k = 0; k < kAxes; ++k) {
    std::array<double, kAxes> others = terms;
    others[k] = 0.0;
    const bool unbounded =
        std::count(others.begin(), others.end(), double{kUnbounded}) != 0;
    opposing[k] = unbounded ? kUnbounded : RoundDown(SumExactly(others));
    if (!unbounded && !CanBeBounded(opposing[k])) return std::nullopt;
  }
  return opposing;
}

template <typename Bound>
std::optional<Bound> TryMerge(const Bound& first, const Bound& second) {
  const Bound& a = IsEmpty(first) ? second : first;
  const Bound& b = IsEmpty(second) ? first : second;
  if (IsEmpty(a)) return Bound::Empty();
  bool ok = true;
  const auto merged = [&](float one, float other) {
    ok &= IsValid(one) && IsValid(other);
    return std::min(one, other);
  };
  Bound result;
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    if constexpr (HasMin<Bound>) result.min[k] = merged(a.min[k], b.min[k]);
    if constexpr (HasMax<Bound>) result.max[k] = -merged(-a.max[k], -b.max[k]);
  }
  if (!ok) return std::nullopt;
  return result;
}

// The mirrored bound: minima and maxima change places.
template <typename Bound>
Bound Mirrored(const Bound& bound) {
  Bound mirrored;
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    mirrored.min[k] = -bound.max[k];
    mirrored.max[k] = -bound.min[k];
  }
  return mirrored;
}

// Coordinates that were moved and rounded.
template <typename Bound, std::size_t kDims>
std::optional<Bound> TryMoveVertices(const Bound& bound,
                                     const std::array<float, kDims>& by) {
  // In float, to nearest, as the vertices are. Rounding is monotone, so the
  // least vertex stays the least.
  const auto rounded = [&](float minimum, std::size_t axis, double sign) {
    return minimum + static_cast<float>(sign) * by[axis];
  };
  std::array<double, 2 * kDims + 1> terms;
  const auto moved = [&](float minimum, std::size_t axis, double sign) {
    if (!IsD<Bound>(axis)) return rounded(minimum, axis, sign);
    for (std::size_t k = 0; k < kDims; ++k) {
      terms[k] = -sign * by[k];
      // Rounding moves a coordinate by half an ulp at most: 2^-24 of it.
      const double low = rounded(bound.min[k], k, 1.0);
      const double high = rounded(bound.max[k], k, 1.0);
      terms[kDims + k] = -0x1p-24 * std::max(std::fabs(low), std::fabs(high));
    }
    terms[2 * kDims] = minimum;
    return RoundDown(SumExactly(terms));
  };
  return ChangePlanes(bound, IsFinite(by), moved);
}

template <typename Bound>
std::optional<Bound> TryScale(const Bound& bound, float factor) {
  constexpr bool kHasBothSides = HasMin<Bound> && HasMax<Bound>;
  const bool is_possible = kHasBothSides ? !std::isnan(factor) : factor >= 0.f;
  if (!is_possible) {
    dispatch::ThrowInvalid(
        "Scale", "factor",
        kHasBothSides ? "a number" : "a number that is not negative",
        dispatch::Shortest(factor));
  }
  if constexpr (kHasBothSides) {
    if (factor < 0.f && !IsEmpty(bound)) {
      return TryScale(Mirrored(bound), -factor);
    }
  }
  const auto scaled = [&](float minimum, std::size_t, double) {
    return RoundDown({double{minimum} * double{factor}, 0.0});
  };
  // An infinite factor shows in the products.
  return ChangePlanes(bound, true, scaled);
}

}  // namespace

template <typename Bound, typename>
Bound Merge(const Bound& a, const Bound& b, FitStatus* status) {
  return Build(status, [&] { return TryMerge(a, b); });
}

template <typename Bound, typename>
Bound Inflate(const Bound& bound, float radius, FitStatus* status) {
  return Build(status, [&] {
    dispatch::CheckLength("Inflate", "radius", radius);
    const auto inflated = [&](float minimum, std::size_t axis, double) {
      if (!IsD<Bound>(axis)) {
        return RoundDown(
            SumExactly(std::array<double, 2>{minimum, -double{radius}}));
      }
      const auto reach =
          kernels::TimesRootOfDims<Bound::kDimensions>(double{radius});
      return RoundDown(SumExactly(
          std::array<double, 4>{minimum, -reach[0], -reach[1], -reach[2]}));
    };
    return ChangePlanes(bound, std::isfinite(radius), inflated);
  });
}

template <typename Bound, typename>
Bound InflateByBox(const Bound& bound, float margin, FitStatus* status) {
  return Build(status, [&] {
    dispatch::CheckLength("InflateByBox", "margin", margin);
    const auto inflated = [&](float minimum, std::size_t axis, double) {
      const double times = IsD<Bound>(axis) ? double{Bound::kDimensions} : 1.0;
      return RoundDown(
          SumExactly(std::array<double, 2>{minimum, -times * margin}));
    };
    return ChangePlanes(bound, std::isfinite(margin), inflated);
  });
}

template <typename Bound, typename>
Bound Translate(const Bound& bound, const Point<Bound::kDimensions>& by,
                FitStatus* status) {
  return Build(status, [&] {
    const auto moved = [&](float minimum, std::size_t axis, double sign) {
      return Moved<Bound>(minimum, axis, sign, by);
    };
    return ChangePlanes(bound, IsFinite(by), moved);
  });
}

template <typename Bound, typename, typename>
Bound TranslateVertices(const Bound& bound, const Point<Bound::kDimensions>& by,
                        FitStatus* status) {
  return Build(status, [&] { return TryMoveVertices(bound, by); });
}

template <typename Bound, typename>
Bound Scale(const Bound& bound, float factor, FitStatus* status) {
  return Build(status, [&] { return TryScale(bound, factor); });
}

template <int kDims>
DownSimplex<kDims> Circumscribe(const UpSimplex<kDims>& simplex,
                                FitStatus* status) {
  using Result = DownSimplex<kDims>;
  return Build(status, [&]() -> std::optional<Result> {
    if (IsEmpty(simplex)) return Result::Empty();
    const auto opposing = TryOpposing(simplex.min);
    if (!opposing) return std::nullopt;
    return Result{Negated(*opposing)};
  });
}

template <int kDims>
UpSimplex<kDims> Circumscribe(const DownSimplex<kDims>& simplex,
                              FitStatus* status) {
  using Result = UpSimplex<kDims>;
  return Build(status, [&]() -> std::optional<Result> {
    if (IsEmpty(simplex)) return Result::Empty();
    const auto opposing = TryOpposing(Negated(simplex.max));
    if (!opposing) return std::nullopt;
    return Result{*opposing};
  });
}

#define HALFSPACE_INSTANTIATE_BOUND(Bound)                                    \
  template HALFSPACE_API Bound Merge(const Bound&, const Bound&, FitStatus*); \
  template HALFSPACE_API Bound Inflate(const Bound&, float, FitStatus*);      \
  template HALFSPACE_API Bound InflateByBox(const Bound&, float, FitStatus*); \
  template HALFSPACE_API Bound Translate(                                     \
      const Bound&, const Point<Bound::kDimensions>&, FitStatus*);            \
  template HALFSPACE_API Bound Scale(const Bound&, float, FitStatus*)
#define HALFSPACE_INSTANTIATE(d)                                          \
  HALFSPACE_INSTANTIATE_BOUND(UpSimplex<d>);                              \
  HALFSPACE_INSTANTIATE_BOUND(DownSimplex<d>);                            \
  HALFSPACE_INSTANTIATE_BOUND(Aabb<d>);                                   \
  HALFSPACE_INSTANTIATE_BOUND(Aabo<d>);                                   \
  template HALFSPACE_API Aabb<d> TranslateVertices(                       \
      const Aabb<d>&, const Point<d>&, FitStatus*);                       \
  template HALFSPACE_API Aabo<d> TranslateVertices(                       \
      const Aabo<d>&, const Point<d>&, FitStatus*);                       \
  template HALFSPACE_API DownSimplex<d> Circumscribe(const UpSimplex<d>&, \
                                                     FitStatus*);         \
  template HALFSPACE_API UpSimplex<d> Circumscribe(const DownSimplex<d>&, \
                                                   FitStatus*)
HALFSPACE_FOR_ALL_DIMS(HALFSPACE_INSTANTIATE);
#undef HALFSPACE_INSTANTIATE
#undef HALFSPACE_INSTANTIATE_BOUND

}  // namespace halfspace
