// Bounds from exact projections, for all single builders.
//
// Only for translation units compiled without fast-math and contraction.
#ifndef HALFSPACE_DISPATCH_EXACT_EXACT_BOUND_H_
#define HALFSPACE_DISPATCH_EXACT_EXACT_BOUND_H_

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/exact/outward.h"
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

constexpr ExactSum Negated(const ExactSum& sum) {
  return {-sum.value, -sum.rest};
}

// D = -(x + y + ...) of a point, exactly.
template <typename Coords>
ExactSum ExactD(const Coords& point) {
  std::array<double, std::tuple_size_v<Coords>> terms;
  std::copy(point.begin(), point.end(), terms.begin());
  return Negated(SumExactly(terms));
}

// The running minimum and maximum of one projection. Sums that double holds
// exactly are compared as they are and rounded once at the end.
class ExactRange {
 public:
  void Add(const ExactSum& sum) {
    if (sum.rest == 0.0) {
      min_ = std::min(min_, sum.value);
      max_ = std::max(max_, sum.value);
    } else {
      min_ = std::min<double>(min_, RoundDown(sum));
      max_ = std::max<double>(max_, RoundUp(sum));
    }
  }
  float min() const { return RoundDown({min_, 0.0}); }
  float max() const { return RoundUp({max_, 0.0}); }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
};

// One range per axis; D, the last, like the others.
template <int kDims>
class ExactRanges {
 public:
  static constexpr std::size_t kAxes = kDims + 1;

  void Add(std::size_t axis, const ExactSum& sum) { ranges_[axis].Add(sum); }

  template <typename Coords>
  void AddPoint(const Coords& point) {
    for (std::size_t k = 0; k < kDims; ++k) Add(k, {point[k], 0.0});
    Add(kDims, ExactD(point));
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
  std::array<ExactRange, kAxes> ranges_;
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

#endif  // HALFSPACE_DISPATCH_EXACT_EXACT_BOUND_H_
