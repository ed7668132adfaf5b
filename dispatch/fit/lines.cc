// Rays, and long segments in pieces.
#include <cstddef>
#include <optional>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/fit/any_shape.h"
#include "dispatch/fit/bounding.h"
#include "dispatch/outward.h"
#include "halfspace/fit.h"

namespace halfspace {
namespace {

using dispatch::AxisRanges;
using dispatch::CanBeBounded;
using dispatch::Finish;
using dispatch::MagnitudeGuard;
using dispatch::OutwardSum;

template <int kDims, typename Scalar>
std::optional<Aabo<kDims>> TryRay(const Ray<kDims, Scalar>& ray) {
  // A direction of 0 goes nowhere, however far.
  MagnitudeGuard<double> guard;
  for (std::size_t k = 0; k < kDims; ++k) {
    guard.Add(ray.origin[k]);
    guard.Add(double{ray.max_t} * double{ray.direction[k]});
  }
  if (!guard.CanBeBounded()) return std::nullopt;
  AxisRanges<kDims> ranges;
  ranges.AddPoint(ray.origin);
  OutwardSum d;
  for (std::size_t k = 0; k < kDims; ++k) {
    OutwardSum end(ray.origin[k]);
    end.AddProduct(ray.max_t, ray.direction[k]);
    ranges.Add(k, end);
    d.Add(-end);
  }
  ranges.Add(kDims, d);
  return ranges.Bound();
}

// Whole numbers that float holds.
constexpr std::size_t kMostPieces = std::size_t{1} << 24;

// The bound of the point ((n - i) a + i b) / n of the segment.
template <int kDims, typename Scalar>
Aabo<kDims> BoundPointAlong(const Segment<kDims, Scalar>& segment,
                            std::size_t i, std::size_t n) {
  const auto divisor = static_cast<double>(n);
  AxisRanges<kDims> ranges;
  OutwardSum d;
  for (std::size_t k = 0; k < kDims; ++k) {
    OutwardSum sum;
    sum.AddProduct(static_cast<Scalar>(n - i), segment.a[k]);
    sum.AddProduct(static_cast<Scalar>(i), segment.b[k]);
    ranges.Add(k, sum.DividedBy(divisor));
    d.Add(-sum);
  }
  ranges.Add(kDims, d.DividedBy(divisor));
  return ranges.Bound();
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
