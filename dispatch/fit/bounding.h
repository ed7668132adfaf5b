// Bounds from projections, for all single builders.
//
// Only for translation units compiled without fast-math and contraction.
#ifndef HALFSPACE_DISPATCH_FIT_BOUNDING_H_
#define HALFSPACE_DISPATCH_FIT_BOUNDING_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/outward.h"
#include "halfspace/bounds.h"
#include "halfspace/fit_status.h"
#include "kernels/compiler.h"

namespace halfspace::dispatch {

// Beyond this sum of magnitudes D might overflow, or its rounding might.
inline constexpr double kLargest = 0x1p125;

// Whether the sum of magnitudes is small enough. It is summed in the type of
// the input and in order, as in the SIMD builders, so both have the same limit.
// NaN and infinity are too large.
template <typename Scalar>
class MagnitudeGuard {
 public:
  void Add(Scalar value) { sum_ += std::fabs(value); }
  template <typename Range>
  void AddAll(const Range& values) {
    for (Scalar value : values) Add(value);
  }
  bool CanBeBounded() const { return sum_ <= Scalar{kLargest}; }

 private:
  Scalar sum_ = 0;
};

template <typename Coords>
bool CanBeBounded(const Coords& point) {
  MagnitudeGuard<typename Coords::value_type> guard;
  guard.AddAll(point);
  return guard.CanBeBounded();
}

// D = -(x + y + ...) of a point.
template <typename Coords>
OutwardSum DOf(const Coords& point) {
  OutwardSum sum(point[0]);
  for (std::size_t k = 1; k < point.size(); ++k) sum.Add(point[k]);
  return -sum;
}

// The running minimum and maximum of one projection. Numbers that double holds
// exactly are compared as they are and rounded once at the end.
class AxisRange {
 public:
  void Add(double exact) {
    min_ = std::min(min_, exact);
    max_ = std::max(max_, exact);
  }
  void Add(const OutwardSum& sum) {
    if (sum.error() == 0.0) return Add(sum.value());
    min_ = std::min<double>(min_, sum.Down());
    max_ = std::max<double>(max_, sum.Up());
  }
  float min() const { return RoundDown(min_); }
  float max() const { return RoundUp(max_); }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
};

// One range per axis; D, the last, like the others.
template <int kDims>
class AxisRanges {
 public:
  static constexpr std::size_t kAxes = kDims + 1;

  template <typename Number>
  void Add(std::size_t axis, const Number& number) {
    ranges_[axis].Add(number);
  }

  template <typename Coords>
  void AddPoint(const Coords& point) {
    for (std::size_t k = 0; k < kDims; ++k) Add(k, double{point[k]});
    Add(kDims, DOf(point));
  }

  Aabo<kDims> Bound() const {
    Aabo<kDims> bound;
    for (std::size_t k = 0; k < kAxes; ++k) {
      bound.min[k] = ranges_[k].min();
      bound.max[k] = ranges_[k].max();
    }
    return bound;
  }

 private:
  std::array<AxisRange, kAxes> ranges_;
};

// Not inlined, because the code that makes the text is long.
template <typename Scalar>
[[noreturn]] HALFSPACE_NOINLINE void ThrowInverted(std::string_view call,
                                                   std::size_t k, Scalar min,
                                                   Scalar max) {
  const std::string axis = "[" + std::to_string(k) + "]";
  ThrowInvalid(call, "box", "min" + axis + " not above max" + axis,
               detail::NumberText(min) + " and " + detail::NumberText(max));
}

// Throws if the box is inverted. The builder handles NaN. Called in the default
// mode, in which a subnormal is not 0.
template <typename Corner>
void CheckOrder(std::string_view call, const Corner& min, const Corner& max) {
  for (std::size_t k = 0; k < min.size(); ++k) {
    if (min[k] > max[k]) ThrowInverted(call, k, min[k], max[k]);
  }
}

// Counts the result. If there is no bound, it is Everything(). Called in the
// default mode.
template <typename Bound>
Bound Finish(const std::optional<Bound>& bound, FitStatus* status) {
  const Bound result = bound.value_or(Bound::Everything());
  if (status != nullptr) {
    if (result == Bound::Everything() && status->everything++ == 0) {
      status->first_everything = status->results;
    }
    ++status->results;
  }
  return result;
}

// Returns the bound that try_bound() returns as a std::optional. try_bound() is
// called in the default mode.
template <typename TryBound>
auto Build(FitStatus* status, const TryBound& try_bound) {
  return InDefaultFpMode([&] { return Finish(try_bound(), status); });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_FIT_BOUNDING_H_
