// Bounds of bounds. Everything is written for minima alone: the maxima of a
// bound are the negated minima of the mirrored shape.
#include "halfspace/transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/fit/any_shape.h"
#include "dispatch/fit/bounding.h"
#include "dispatch/outward.h"
#include "halfspace/detail/plane_arrays.h"
#include "kernels/fit_many/root_of_dims.h"

namespace halfspace::detail {
namespace {

using dispatch::OutwardSum;

constexpr float kUnbounded = -kMax<float>;  // as a minimum
constexpr float kMostMagnitude = 0x1p126f;

// False for NaN too.
bool CanBeBounded(float minimum) {
  return std::fabs(minimum) <= kMostMagnitude;
}

bool IsValid(float minimum) {
  return minimum == kUnbounded || CanBeBounded(minimum);
}

// Whether test(minimum) is true for each minimum and mirrored maximum.
template <typename Test>
bool AreAll(const AnyBound& bound, const float* values, const Test& test) {
  const float* const maxima = values + bound.min_count;
  return std::all_of(values, maxima, test) &&
         std::all_of(maxima, maxima + bound.max_count,
                     [&](float max) { return test(-max); });
}

bool IsEmpty(const AnyBound& bound, const float* values) {
  return AreAll(bound, values, [](float v) { return v >= kMax<float>; });
}

void Fill(AnyBound& bound, float minimum) {
  std::fill_n(bound.values, bound.min_count, minimum);
  std::fill_n(bound.values + bound.min_count, bound.max_count, -minimum);
}

// Calls try_change(dims), which replaces the values or returns false if they
// cannot be bounded, in the default mode. Counts the result.
template <typename TryChange>
void Build(AnyBound& bound, FitStatus* status, const TryChange& try_change) {
  dispatch::InDefaultFpMode([&] {
    const bool is_bounded =
        dispatch::WithDims(static_cast<int>(bound.dims), [&]<int kDims>() {
          return try_change(std::integral_constant<int, kDims>());
        });
    if (!is_bounded) Fill(bound, kUnbounded);
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
// change_axis(minimum, axis, sign), and of D by change_d(minimum, sign).
// Returns false if a value cannot be bounded, or if the amount of the change is
// not finite: the result is then Everything(). An Empty() bound stays Empty().
template <std::size_t kDims, typename ChangeAxis, typename ChangeD>
bool ChangePlanes(AnyBound& bound, bool is_finite,
                  const ChangeAxis& change_axis, const ChangeD& change_d) {
  if (IsEmpty(bound, bound.values)) {
    Fill(bound, kInf<float>);
    return true;
  }
  if (!is_finite) return false;
  bool ok = true;
  const auto set = [&ok](float& value, float sign, const auto& change) {
    const float minimum = sign * value;
    if (minimum == kUnbounded) return;
    const float result = change(minimum);
    ok &= CanBeBounded(minimum) && IsValid(result);
    value = sign * result;
  };
  const auto change_side = [&](float* values, std::size_t axes, float sign) {
    if (axes == 0) return;
    for (std::size_t k = 0; k < kDims; ++k) {
      set(values[k], sign,
          [&](float minimum) { return change_axis(minimum, k, sign); });
    }
    if (axes == kDims) return;
    set(values[kDims], sign,
        [&](float minimum) { return change_d(minimum, sign); });
  };
  change_side(bound.values, bound.min_count, 1.0f);
  change_side(bound.values + bound.min_count, bound.max_count, -1.0f);
  return ok;
}

template <std::size_t kDims>
bool IsFinite(const float* coords) {
  return std::all_of(coords, coords + kDims,
                     [](float x) { return std::isfinite(x); });
}

float Plus(float minimum, double more) {
  OutwardSum sum(minimum);
  sum.Add(more);
  return sum.Down();
}

// Minima and maxima change places.
void Mirror(AnyBound& bound) {
  for (std::size_t k = 0; k < bound.min_count; ++k) {
    const float min = bound.values[k];
    bound.values[k] = -bound.values[bound.min_count + k];
    bound.values[bound.min_count + k] = -min;
  }
}

}  // namespace

void Merge(AnyBound& bound, const float* other, FitStatus* status) {
  Build(bound, status, [&](auto) {
    const float* const a = IsEmpty(bound, bound.values) ? other : bound.values;
    const float* const b = IsEmpty(bound, other) ? bound.values : other;
    if (IsEmpty(bound, a)) {
      Fill(bound, kInf<float>);
      return true;
    }
    bool ok = true;
    const auto merge = [&](std::size_t i, float sign) {
      const float one = sign * a[i];
      const float two = sign * b[i];
      ok &= IsValid(one) && IsValid(two);
      bound.values[i] = sign * std::min(one, two);
    };
    const std::size_t count = bound.min_count + bound.max_count;
    for (std::size_t i = 0; i < bound.min_count; ++i) merge(i, 1.0f);
    for (std::size_t i = bound.min_count; i < count; ++i) merge(i, -1.0f);
    return ok;
  });
}

void Inflate(AnyBound& bound, float radius, FitStatus* status) {
  Build(bound, status, [&](auto dims) {
    dispatch::CheckLength("Inflate", "radius", radius);
    return ChangePlanes<dims>(
        bound, std::isfinite(radius),
        [&](float minimum, std::size_t, float) {
          return Plus(minimum, -double{radius});
        },
        [&](float minimum, float) {
          OutwardSum sum(minimum);
          sum.AddProduct(-double{radius}, kernels::kRootOfDims<dims>);
          return sum.Down();
        });
  });
}

void InflateByBox(AnyBound& bound, float margin, FitStatus* status) {
  Build(bound, status, [&](auto dims) {
    dispatch::CheckLength("InflateByBox", "margin", margin);
    return ChangePlanes<dims>(
        bound, std::isfinite(margin),
        [&](float minimum, std::size_t, float) {
          return Plus(minimum, -double{margin});
        },
        [&](float minimum, float) {
          return Plus(minimum, -double{dims} * margin);
        });
  });
}

void Translate(AnyBound& bound, const float* by, FitStatus* status) {
  Build(bound, status, [&](auto dims) {
    return ChangePlanes<dims>(
        bound, IsFinite<dims>(by),
        [&](float minimum, std::size_t axis, float sign) {
          return Plus(minimum, double{sign} * by[axis]);
        },
        [&](float minimum, float sign) {
          OutwardSum sum(minimum);
          for (std::size_t k = 0; k < dims; ++k) sum.Add(-sign * by[k]);
          return sum.Down();
        });
  });
}

// In float, to nearest, as the vertices are. Rounding is monotone, so the least
// vertex stays the least.
void TranslateVertices(AnyBound& bound, const float* by, FitStatus* status) {
  Build(bound, status, [&](auto dims) {
    // Rounding moves a coordinate by half an ulp at most: 2^-24 of it.
    std::array<double, dims> rounded;
    for (std::size_t k = 0; k < dims; ++k) {
      const float low = bound.values[k] + by[k];
      const float high = bound.values[bound.min_count + k] + by[k];
      rounded[k] = 0x1p-24 * std::max(std::fabs(low), std::fabs(high));
    }
    return ChangePlanes<dims>(
        bound, IsFinite<dims>(by),
        [&](float minimum, std::size_t axis, float sign) {
          return minimum + sign * by[axis];
        },
        [&](float minimum, float sign) {
          OutwardSum sum(minimum);
          for (std::size_t k = 0; k < dims; ++k) {
            sum.Add(-sign * by[k]);
            sum.Add(-rounded[k]);
          }
          return sum.Down();
        });
  });
}

void Scale(AnyBound& bound, float factor, FitStatus* status) {
  Build(bound, status, [&](auto dims) {
    const bool has_both_sides = bound.min_count != 0 && bound.max_count != 0;
    if (has_both_sides ? std::isnan(factor) : !(factor >= 0.f)) {
      dispatch::ThrowInvalid(
          "Scale", "factor",
          has_both_sides ? "a number" : "a number that is not negative",
          detail::NumberText(factor));
    }
    if (factor < 0.f && !IsEmpty(bound, bound.values)) {
      Mirror(bound);
      factor = -factor;
    }
    const auto scaled = [&](float minimum) {
      return dispatch::RoundDown(double{minimum} * double{factor});
    };
    // An infinite factor shows in the products.
    return ChangePlanes<dims>(
        bound, true,
        [&](float minimum, std::size_t, float) { return scaled(minimum); },
        [&](float minimum, float) { return scaled(minimum); });
  });
}

}  // namespace halfspace::detail
