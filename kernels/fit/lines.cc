// Rays, and long segments in pieces.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>

#include "halfspace/fit.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/exact/exact_bound.h"
#include "kernels/exact/outward.h"
#include "kernels/exact/quotient.h"
#include "kernels/memory_checks.h"

namespace halfspace {
namespace {

using kernels::CanBeBounded;
using kernels::ExactRanges;
using kernels::ExactSum;
using kernels::Finish;
using kernels::InDefaultFpMode;
using kernels::MagnitudeGuard;
using kernels::Negated;
using kernels::SumExactly;

template <int kDims>
std::optional<Aabo<kDims>> TryRay(const Ray<kDims>& ray) {
  // A direction of 0 goes nowhere, however far.
  std::array<std::array<double, 2>, kDims> end;
  std::array<double, 2 * kDims> all;
  MagnitudeGuard<double> guard;
  for (std::size_t k = 0; k < kDims; ++k) {
    end[k] = {ray.origin[k], double{ray.max_t} * double{ray.direction[k]}};
    all[2 * k] = end[k][0];
    all[2 * k + 1] = end[k][1];
  }
  guard.AddAll(all);
  if (!guard.CanBeBounded()) return std::nullopt;
  ExactRanges<kDims> ranges;
  ranges.AddPoint(ray.origin);
  for (std::size_t k = 0; k < kDims; ++k) ranges.Add(k, SumExactly(end[k]));
  ranges.Add(kDims, Negated(SumExactly(all)));
  return ranges.Bound();
}

constexpr std::size_t kMostPieces = std::size_t{1} << 24;

// Encloses exact / divisor on one axis of the bound.
template <int kDims>
void SetQuotient(const ExactSum& exact, double divisor, std::size_t axis,
                 Aabo<kDims>& bound) {
  bound.min[axis] = kernels::QuotientDown(exact, {divisor, 0.0});
  bound.max[axis] = kernels::QuotientUp(exact, {divisor, 0.0});
}

// The bound of the point ((n - i) a + i b) / n of the segment. Products of a
// float and a whole number up to 2^24 are exact in double.
template <int kDims>
Aabo<kDims> BoundPointAlong(const Segment<kDims>& segment, std::size_t i,
                            std::size_t n) {
  const auto divisor = static_cast<double>(n);
  const auto weight_a = static_cast<double>(n - i);
  const auto weight_b = static_cast<double>(i);
  Aabo<kDims> bound;
  std::array<double, 2 * kDims> all;
  for (std::size_t k = 0; k < kDims; ++k) {
    const std::array<double, 2> terms = {weight_a * segment.a[k],
                                         weight_b * segment.b[k]};
    all[2 * k] = terms[0];
    all[2 * k + 1] = terms[1];
    SetQuotient(SumExactly(terms), divisor, k, bound);
  }
  SetQuotient(Negated(SumExactly(all)), divisor, kDims, bound);
  return bound;
}

template <int kDims>
void WritePieces(const Segment<kDims>& segment, Span<Aabo<kDims>> pieces,
                 FitStatus* status) {
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

template <int kDims>
Aabo<kDims> BoundRay(const Ray<kDims>& ray, FitStatus* status) {
  return InDefaultFpMode([&] {
    kernels::CheckLength("BoundRay", "ray.max_t", ray.max_t);
    return Finish(TryRay(ray), status);
  });
}

template <int kDims>
void BoundSegmentPieces(const Segment<kDims>& segment,
                        std::decay_t<Span<Aabo<kDims>>> pieces,
                        FitStatus* status) {
  if (pieces.size() > kMostPieces) {
    kernels::ThrowInvalid("BoundSegmentPieces", "pieces", "at most 2^24 pieces",
                          std::to_string(pieces.size()));
  }
  if (pieces.empty()) return;
  kernels::CheckPointer(
      "BoundSegmentPieces", pieces.data(), alignof(Aabo<kDims>),
      [] { return "pieces"; },
      [&] { return "room for " + std::to_string(pieces.size()); });
  InDefaultFpMode([&] { WritePieces(segment, pieces, status); });
}

#define HALFSPACE_INSTANTIATE(d)                                       \
  template HALFSPACE_API Aabo<d> BoundRay(const Ray<d>&, FitStatus*);  \
  template HALFSPACE_API void BoundSegmentPieces<d>(const Segment<d>&, \
                                                    Span<Aabo<d>>, FitStatus*)
HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);
#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace
