// Bounds of bounds. Everything is written for minima alone: the maxima of a
// bound are the negated minima of the mirrored shape.
#include "halfspace/transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "dispatch/errors/error.h"
#include "dispatch/exact/default_fp_mode.h"
#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/outward.h"
#include "halfspace/detail/plane_arrays.h"
#include "kernels/fit_many/root_of_dims.h"

namespace halfspace::detail {
namespace {

using dispatch::RoundDown;
using dispatch::SumExactly;

constexpr std::size_t kMostDims = 4;
constexpr std::size_t kMostTerms = 2 * kMostDims + 1;
constexpr float kUnbounded = -kMax<float>;  // as a minimum
constexpr float kMostMagnitude = 0x1p126f;

// False for NaN too.
bool CanBeBounded(float minimum) {
  return std::fabs(minimum) <= kMostMagnitude;
}

bool IsValid(float minimum) {
  return minimum == kUnbounded || CanBeBounded(minimum);
}

std::size_t CountOf(const AnyBound& bound) {
  return bound.minima + bound.maxima;
}
std::size_t AxisOf(const AnyBound& bound, std::size_t i) {
  return i < bound.minima ? i : i - bound.minima;
}
// -1 for the mirrored.
float SignOf(const AnyBound& bound, std::size_t i) {
  return i < bound.minima ? 1.0f : -1.0f;
}

bool HasBothSides(const AnyBound& bound) {
  return bound.minima != 0 && bound.maxima != 0;
}

// Whether test(minimum) is true for each minimum and mirrored maximum.
template <typename Test>
bool AreAll(const AnyBound& bound, const float* values, const Test& test) {
  for (std::size_t i = 0; i < CountOf(bound); ++i) {
    if (!test(SignOf(bound, i) * values[i])) return false;
  }
  return true;
}

bool IsEmpty(const AnyBound& bound, const float* values) {
  return AreAll(bound, values, [](float v) { return v >= kMax<float>; });
}

void Fill(const AnyBound& bound, float minimum) {
  for (std::size_t i = 0; i < CountOf(bound); ++i) {
    bound.values[i] = SignOf(bound, i) * minimum;
  }
}

// Calls try_change(), which replaces the values or returns false if they cannot
// be bounded, in the default mode. Counts the result.
template <typename TryChange>
void Build(const AnyBound& bound, FitStatus* status,
           const TryChange& try_change) {
  dispatch::InDefaultFpMode([&] {
    if (!try_change()) Fill(bound, kUnbounded);
    if (status == nullptr) return;
    const bool is_everything =
        AreAll(bound, bound.values, [](float v) { return v == kUnbounded; });
    if (is_everything && status->everything++ == 0) {
      status->first_everything = status->results;
    }
    ++status->results;
  });
}

// Replaces each minimum of the bound, and each mirrored maximum, by
// change(minimum, axis, sign). Returns false if a value cannot be bounded.
// Nothing stays nothing, whatever the change; by an amount that is not finite,
// all else becomes everything.
template <typename Change>
bool ChangePlanes(const AnyBound& bound, bool is_finite, const Change& change) {
  if (IsEmpty(bound, bound.values)) {
    Fill(bound, kInf<float>);
    return true;
  }
  if (!is_finite) return false;
  bool ok = true;
  std::array<float, kMaxPlanes> changed;
  for (std::size_t i = 0; i < CountOf(bound); ++i) {
    const float sign = SignOf(bound, i);
    const float minimum = sign * bound.values[i];
    float result = kUnbounded;
    if (minimum != kUnbounded) {
      result = change(minimum, AxisOf(bound, i), sign);
      ok &= CanBeBounded(minimum) && IsValid(result);
    }
    changed[i] = sign * result;
  }
  std::copy_n(changed.begin(), CountOf(bound), bound.values);
  return ok;
}

bool AreFinite(const float* coords, std::size_t dims) {
  return std::all_of(coords, coords + dims,
                     [](float x) { return std::isfinite(x); });
}

float PlusExactly(float minimum, double more) {
  return RoundDown(SumExactly(std::array<double, 2>{minimum, more}));
}

// The exact sum of a few terms, whose number is known where it is computed.
dispatch::ExactSum SumOf(const double* terms, std::size_t count) {
  const auto sum = [terms](auto constant) {
    std::array<double, decltype(constant)::value> some;
    std::copy_n(terms, some.size(), some.begin());
    return SumExactly(some);
  };
  switch (count) {
    case 3:
      return sum(std::integral_constant<std::size_t, 3>());
    case 4:
      return sum(std::integral_constant<std::size_t, 4>());
    case 5:
      return sum(std::integral_constant<std::size_t, 5>());
    case 7:
      return sum(std::integral_constant<std::size_t, 7>());
    default:
      return sum(std::integral_constant<std::size_t, kMostTerms>());
  }
}

// A minimum of D after the points moved by sign * `by`, less the `count`
// numbers of `less`.
float MovedD(const AnyBound& bound, float minimum, float sign, const float* by,
             const double* less, std::size_t count) {
  double terms[kMostTerms];
  for (std::size_t k = 0; k < bound.dims; ++k) terms[k] = -sign * by[k];
  for (std::size_t k = 0; k < count; ++k) terms[bound.dims + k] = -less[k];
  terms[bound.dims + count] = minimum;
  return RoundDown(SumOf(terms, bound.dims + count + 1));
}

// The opposing simplex' minima, mirrored: on each axis, minus the sum of the
// others, since all axes sum to zero.
bool TryOpposing(const AnyBound& simplex) {
  std::array<double, kMostDims + 1> terms{};
  std::copy_n(simplex.values, simplex.minima, terms.begin());
  bool is_bounded = true;
  for (std::size_t k = 0; k < simplex.minima; ++k) {
    const float minimum = simplex.values[k];
    if (minimum == kUnbounded) {
      is_bounded = false;
    } else if (!CanBeBounded(minimum)) {
      return false;
    }
  }
  if (is_bounded && SumOf(terms.data(), simplex.minima).value > 0.0) {
    dispatch::ThrowInvalid("Circumscribe", "simplex",
                           "planes that sum to 0 or less",
                           "a simplex that contains no point");
  }
  for (std::size_t k = 0; k < simplex.minima; ++k) {
    std::array<double, kMostDims + 1> others = terms;
    others[k] = 0.0;
    const bool unbounded =
        std::count(others.begin(), others.end(), double{kUnbounded}) != 0;
    float& opposing = simplex.values[k];
    opposing = unbounded ? kUnbounded
                         : RoundDown(SumOf(others.data(), simplex.minima));
    if (!unbounded && !CanBeBounded(opposing)) return false;
  }
  return true;
}

// Minima and maxima change places.
void Mirror(const AnyBound& bound) {
  for (std::size_t k = 0; k < bound.minima; ++k) {
    const float min = bound.values[k];
    bound.values[k] = -bound.values[bound.minima + k];
    bound.values[bound.minima + k] = -min;
  }
}

}  // namespace

void Merge(const AnyBound& bound, const float* other, FitStatus* status) {
  Build(bound, status, [&] {
    const float* const a = IsEmpty(bound, bound.values) ? other : bound.values;
    const float* const b = IsEmpty(bound, other) ? bound.values : other;
    if (IsEmpty(bound, a)) {
      Fill(bound, kInf<float>);
      return true;
    }
    bool ok = true;
    for (std::size_t i = 0; i < CountOf(bound); ++i) {
      const float sign = SignOf(bound, i);
      const float one = sign * a[i];
      const float two = sign * b[i];
      ok &= IsValid(one) && IsValid(two);
      bound.values[i] = sign * std::min(one, two);
    }
    return ok;
  });
}

void Inflate(const AnyBound& bound, float radius, FitStatus* status) {
  Build(bound, status, [&] {
    dispatch::CheckLength("Inflate", "radius", radius);
    const auto reach = [&] {
      if (bound.dims == 2) return kernels::TimesRootOfDims<2>(double{radius});
      if (bound.dims == 3) return kernels::TimesRootOfDims<3>(double{radius});
      return kernels::TimesRootOfDims<4>(double{radius});
    };
    return ChangePlanes(bound, std::isfinite(radius),
                        [&](float minimum, std::size_t axis, float) {
                          if (axis != bound.dims)
                            return PlusExactly(minimum, -double{radius});
                          const auto parts = reach();
                          return RoundDown(SumExactly(std::array<double, 4>{
                              minimum, -parts[0], -parts[1], -parts[2]}));
                        });
  });
}

void InflateByBox(const AnyBound& bound, float margin, FitStatus* status) {
  Build(bound, status, [&] {
    dispatch::CheckLength("InflateByBox", "margin", margin);
    return ChangePlanes(
        bound, std::isfinite(margin),
        [&](float minimum, std::size_t axis, float) {
          const double times =
              axis == bound.dims ? static_cast<double>(bound.dims) : 1.0;
          return PlusExactly(minimum, -times * margin);
        });
  });
}

void Translate(const AnyBound& bound, const float* by, FitStatus* status) {
  Build(bound, status, [&] {
    return ChangePlanes(bound, AreFinite(by, bound.dims),
                        [&](float minimum, std::size_t axis, float sign) {
                          if (axis != bound.dims) {
                            return PlusExactly(minimum,
                                               double{sign} * by[axis]);
                          }
                          return MovedD(bound, minimum, sign, by, nullptr, 0);
                        });
  });
}

// In float, to nearest, as the vertices are. Rounding is monotone, so the least
// vertex stays the least.
void TranslateVertices(const AnyBound& bound, const float* by,
                       FitStatus* status) {
  Build(bound, status, [&] {
    return ChangePlanes(
        bound, AreFinite(by, bound.dims),
        [&](float minimum, std::size_t axis, float sign) {
          if (axis != bound.dims) return minimum + sign * by[axis];
          // Rounding moves a coordinate by half an ulp at most: 2^-24 of it.
          std::array<double, kMostDims> rounded;
          for (std::size_t k = 0; k < bound.dims; ++k) {
            const float low = bound.values[k] + by[k];
            const float high = bound.values[bound.minima + k] + by[k];
            rounded[k] = 0x1p-24 * std::max(std::fabs(low), std::fabs(high));
          }
          return MovedD(bound, minimum, sign, by, rounded.data(), bound.dims);
        });
  });
}

void Scale(const AnyBound& bound, float factor, FitStatus* status) {
  Build(bound, status, [&] {
    const bool has_both_sides = HasBothSides(bound);
    if (has_both_sides ? std::isnan(factor) : !(factor >= 0.f)) {
      dispatch::ThrowInvalid(
          "Scale", "factor",
          has_both_sides ? "a number" : "a number that is not negative",
          dispatch::Shortest(factor));
    }
    if (factor < 0.f && !IsEmpty(bound, bound.values)) {
      Mirror(bound);
      factor = -factor;
    }
    // An infinite factor shows in the products.
    return ChangePlanes(bound, true, [&](float minimum, std::size_t, float) {
      return RoundDown({double{minimum} * double{factor}, 0.0});
    });
  });
}

void Circumscribe(const AnyBound& simplex, FitStatus* status) {
  Build(simplex, status, [&] {
    if (!IsEmpty(simplex, simplex.values)) return TryOpposing(simplex);
    Fill(simplex, kInf<float>);
    return true;
  });
}

}  // namespace halfspace::detail
