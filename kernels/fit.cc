#include "halfspace/fit.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "kernels/default_fp_mode.h"
#include "kernels/error.h"
#include "kernels/outward.h"

namespace halfspace {
namespace {

using kernels::ExactSum;
using kernels::RoundDown;
using kernels::RoundUp;
using kernels::SumExactly;

// Beyond this sum of magnitudes D might overflow, or its rounding might.
constexpr double kLargest = 0x1p125;

template <int kDims>
using Point = std::array<double, kDims>;

// False for NaN and infinity too.
template <int kDims>
bool CanBeBounded(const Point<kDims>& point) {
  double magnitude = 0.0;
  for (double x : point) magnitude += std::fabs(x);
  return magnitude <= kLargest;
}

// D = -(x + y + ...), exactly.
template <int kDims>
ExactSum ExactD(const Point<kDims>& point) {
  const ExactSum sum = SumExactly(point);
  return {-sum.value, -sum.rest};
}

// The running minimum and maximum of D over a point set. Sums that double holds
// exactly are compared as they are and rounded once at the end.
class DRange {
 public:
  void Add(const ExactSum& d) {
    if (d.rest == 0.0) {
      min_ = std::min(min_, d.value);
      max_ = std::max(max_, d.value);
    } else {
      min_ = std::min<double>(min_, RoundDown(d));
      max_ = std::max<double>(max_, RoundUp(d));
    }
  }
  float min() const { return RoundDown({min_, 0.0}); }
  float max() const { return RoundUp({max_, 0.0}); }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
};

template <int kDims>
void CheckPoints(const Points<kDims>& points) {
  constexpr std::size_t kMostFloats =
      std::numeric_limits<std::size_t>::max() / sizeof(float);
  if (points.coords == nullptr) {
    kernels::ThrowInvalid("BoundPoints", "points.coords",
                          std::to_string(points.count) + " points",
                          "a null pointer");
  }
  if (reinterpret_cast<std::uintptr_t>(points.coords) % alignof(float) != 0) {
    kernels::ThrowInvalid("BoundPoints", "points.coords",
                          "a pointer aligned to float", "a misaligned one");
  }
  // (count - 1) * stride + kDims floats, without overflow.
  const bool fits = points.stride == 0 ||
                    points.count - 1 <= (kMostFloats - kDims) / points.stride;
  if (!fits) {
    kernels::ThrowInvalid("BoundPoints", "points.count",
                          "points that fit the address space with stride " +
                              std::to_string(points.stride),
                          std::to_string(points.count));
  }
}

// Enough digits to tell any two floats apart.
std::string Shortest(float value) {
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return std::string(text.data(), end);
}

template <int kDims>
void CheckAabb(const Aabb<kDims>& box) {
  for (int k = 0; k < kDims; ++k) {
    if (box.min[k] > box.max[k]) {
      const std::string axis = "[" + std::to_string(k) + "]";
      kernels::ThrowInvalid(
          "BoundAabb", "box", "min" + axis + " not above max" + axis,
          Shortest(box.min[k]) + " and " + Shortest(box.max[k]));
    }
  }
}

// The arithmetic, for checked arguments and in the default mode. Nothing if a
// point cannot be bounded.
template <int kDims>
HALFSPACE_NOINLINE std::optional<Aabo<kDims>> TryPoints(
    const Points<kDims>& points) {
  Aabo<kDims> bound = Aabo<kDims>::Empty();
  DRange d;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float* coords = points.coords + i * points.stride;
    Point<kDims> point;
    std::copy_n(coords, kDims, point.begin());
    if (!CanBeBounded<kDims>(point)) return std::nullopt;
    for (int k = 0; k < kDims; ++k) {
      bound.min[k] = std::min(bound.min[k], coords[k]);
      bound.max[k] = std::max(bound.max[k], coords[k]);
    }
    d.Add(ExactD<kDims>(point));
  }
  bound.min[kDims] = d.min();
  bound.max[kDims] = d.max();
  return bound;
}

template <int kDims>
HALFSPACE_NOINLINE std::optional<Aabo<kDims>> TryAabb(const Aabb<kDims>& box) {
  CheckAabb(box);
  Aabo<kDims> bound;
  Point<kDims> low;
  Point<kDims> high;
  for (int k = 0; k < kDims; ++k) {
    low[k] = bound.min[k] = box.min[k];
    high[k] = bound.max[k] = box.max[k];
  }
  if (!CanBeBounded<kDims>(low) || !CanBeBounded<kDims>(high)) {
    return std::nullopt;
  }
  // D falls as the coordinates rise: its extremes are at the two corners.
  bound.min[kDims] = RoundDown(ExactD<kDims>(high));
  bound.max[kDims] = RoundUp(ExactD<kDims>(low));
  return bound;
}

template <int kDims>
Aabo<kDims> Finish(const std::optional<Aabo<kDims>>& bound, FitStatus* status) {
  if (status != nullptr) {
    if (!bound && status->everything++ == 0) {
      status->first_everything = status->calls;
    }
    ++status->calls;
  }
  return bound.value_or(Aabo<kDims>::Everything());
}

}  // namespace

template <int kDims>
Aabo<kDims> BoundPoints(const Points<kDims>& points, FitStatus* status) {
  if (points.count == 0) {
    return Finish<kDims>(Aabo<kDims>::Empty(), status);
  }
  CheckPoints(points);
  const kernels::DefaultFpMode mode;
  return Finish(TryPoints(points), status);
}

template <int kDims>
Aabo<kDims> BoundAabb(const Aabb<kDims>& box, FitStatus* status) {
  if (box == Aabb<kDims>::Empty()) {
    return Finish<kDims>(Aabo<kDims>::Empty(), status);
  }
  const kernels::DefaultFpMode mode;
  return Finish(TryAabb(box), status);
}

#define HALFSPACE_INSTANTIATE(dims)                                  \
  template HALFSPACE_API Aabo<dims> BoundPoints(const Points<dims>&, \
                                                FitStatus*);         \
  template HALFSPACE_API Aabo<dims> BoundAabb(const Aabb<dims>&, FitStatus*)
HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);
#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace
