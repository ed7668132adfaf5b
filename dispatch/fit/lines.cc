// Rays, and long segments in pieces.
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/exact/exact_bound.h"
#include "dispatch/exact/exact_terms.h"
#include "dispatch/exact/outward.h"
#include "dispatch/fit/any_shape.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::CanBeBounded;
using dispatch::ExactRanges;
using dispatch::ExactSum;
using dispatch::ExactTerms;
using dispatch::Finish;
using dispatch::MagnitudeGuard;
using dispatch::Negated;

template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryRay(const Ray<kDims, Scalar>& ray) {
  // A direction of 0 goes nowhere, however far.
  MagnitudeGuard<double> guard;
  for (std::size_t k = 0; k < kDims; ++k) {
    guard.Add(ray.origin[k]);
    guard.Add(double{ray.max_t} * double{ray.direction[k]});
  }
  if (!guard.CanBeBounded()) return std::nullopt;
  ExactRanges<kDims> ranges;
  ranges.AddPoint(ray.origin);
  ExactTerms<Scalar, std::size_t{kDims}, std::size_t{kDims}> all;
  for (std::size_t k = 0; k < kDims; ++k) {
    ExactTerms<Scalar, 1, 1> end;
    end.Add(ray.origin[k]);
    end.AddProduct(ray.max_t, ray.direction[k]);
    all.Add(ray.origin[k]);
    all.AddProduct(ray.max_t, ray.direction[k]);
    ranges.Add(k, end.SumToRound());
  }
  ranges.Add(kDims, Negated(all.SumToRound()));
  return ranges.Bound();
}

// The relative error of value / value. Both values are off by less than an ulp,
// 2^-52, and the division rounds once.
constexpr double kQuotientError = 0x1p-50;

// Returns a float that is not above numerator / denominator. The denominator is
// not 0. It is the largest such float if doubles hold both sums, and else at
// most one float below that. Both sums must be far from the limits of double.
float QuotientDown(const ExactSum& numerator, const ExactSum& denominator) {
  const double quotient = numerator.value / denominator.value;
  if (numerator.rest == 0.0 && denominator.rest == 0.0) {
    const double remainder =
        std::fma(-quotient, denominator.value, numerator.value);
    const bool is_above = (remainder < 0.0 && denominator.value > 0.0) ||
                          (remainder > 0.0 && denominator.value < 0.0);
    return dispatch::RoundDown({quotient, is_above ? -1.0 : 0.0});
  }
  const double below = quotient - std::fabs(quotient) * kQuotientError;
  return dispatch::RoundDown(
      {std::nextafter(below, -std::numeric_limits<double>::infinity()), 0.0});
}

float QuotientUp(const ExactSum& numerator, const ExactSum& denominator) {
  return -QuotientDown({-numerator.value, -numerator.rest}, denominator);
}

// Whole numbers that float holds.
constexpr std::size_t kMostPieces = std::size_t{1} << 24;

// Encloses exact / divisor on one axis of the bound.
template <int kDims>
void SetQuotient(const ExactSum& exact, double divisor, std::size_t axis,
                 Aabo<kDims>& bound) {
  bound.min[axis] = QuotientDown(exact, {divisor, 0.0});
  bound.max[axis] = QuotientUp(exact, {divisor, 0.0});
}

// The bound of the point ((n - i) a + i b) / n of the segment.
template <int kDims, typename Scalar>
Aabo<kDims> BoundPointAlong(const Segment<kDims, Scalar>& segment,
                            std::size_t i, std::size_t n) {
  const auto divisor = static_cast<double>(n);
  const auto weight_a = static_cast<Scalar>(n - i);
  const auto weight_b = static_cast<Scalar>(i);
  Aabo<kDims> bound;
  ExactTerms<Scalar, 2 * std::size_t{kDims}, 0> all;
  for (std::size_t k = 0; k < kDims; ++k) {
    ExactTerms<Scalar, 2, 0> terms;
    terms.AddProduct(weight_a, segment.a[k]);
    terms.AddProduct(weight_b, segment.b[k]);
    all.AddProduct(weight_a, segment.a[k]);
    all.AddProduct(weight_b, segment.b[k]);
    SetQuotient(terms.Sum(), divisor, k, bound);
  }
  SetQuotient(Negated(all.Sum()), divisor, kDims, bound);
  return bound;
}

template <int kDims, typename Scalar>
void WritePieces(const Segment<kDims, Scalar>& segment,
                 Span<Aabo<kDims>> pieces, FitStatus* status) {
  const bool can_be_bounded =
      CanBeBounded(segment.a) && CanBeBounded(segment.b);
  Aabo<kDims> begin = Aabo<kDims>::Everything();
  if (can_be_bounded) begin = BoundPointAlong(segment, 0, pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    Aabo<kDims> end = begin;
    if (can_be_bounded) end = BoundPointAlong(segment, i + 1, pieces.size());
    pieces[i] = Finish<Aabo<kDims>>(Merge(begin, end), status);
    begin = end;
  }
}

}  // namespace

void detail::BoundRay(const AnyShape& ray, FitStatus* status) {
  dispatch::BoundAny<Ray>(ray, status, [](const auto& its) {
    dispatch::CheckLength("BoundRay", "ray.max_t", its.max_t);
    return TryRay(its);
  });
}

void detail::BoundSegmentPieces(const AnyShape& segment, std::size_t pieces,
                                FitStatus* status) {
  constexpr const char* kCall = "BoundSegmentPieces";
  if (pieces > kMostPieces) {
    dispatch::ThrowInvalid(kCall, "pieces", "at most 2^24 pieces",
                           std::to_string(pieces));
  }
  if (pieces == 0) return;
  dispatch::CheckPointer(
      kCall, segment.bound, alignof(float), [] { return "pieces"; },
      [&] { return "room for " + std::to_string(pieces); });
  dispatch::WithShape<Segment>(segment, [&]<int kDims, typename Scalar>(
                                            const Segment<kDims, Scalar>& its) {
    const Span<Aabo<kDims>> to(static_cast<Aabo<kDims>*>(segment.bound),
                               pieces);
    dispatch::InDefaultFpMode([&] { WritePieces(its, to, status); });
  });
}

}  // namespace halfspace
