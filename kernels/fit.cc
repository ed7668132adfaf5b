#include "halfspace/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

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
Aabo<kDims> Finish(const Aabo<kDims>& bound, bool is_everything,
                   FitStatus* status) {
  if (status != nullptr) {
    if (is_everything && status->everything++ == 0) {
      status->first_everything = status->calls;
    }
    ++status->calls;
  }
  return is_everything ? Aabo<kDims>::Everything() : bound;
}

template <int kDims>
void CheckPoints(const Points<kDims>& points) {
  if (points.coords == nullptr) {
    kernels::ThrowInvalid("BoundPoints", "points.coords",
                          std::to_string(points.count) + " points",
                          "a null pointer");
  }
  if (reinterpret_cast<std::uintptr_t>(points.coords) % alignof(float) != 0) {
    kernels::ThrowInvalid("BoundPoints", "points.coords",
                          "a pointer aligned to float", "a misaligned one");
  }
}

}  // namespace

template <int kDims>
Aabo<kDims> BoundPoints(const Points<kDims>& points, FitStatus* status) {
  Aabo<kDims> bound = Aabo<kDims>::Empty();
  if (points.count == 0) return Finish(bound, false, status);
  CheckPoints(points);
  DRange d;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float* coords = points.coords + i * points.stride;
    Point<kDims> point;
    std::copy_n(coords, kDims, point.begin());
    if (!CanBeBounded<kDims>(point)) return Finish(bound, true, status);
    for (int k = 0; k < kDims; ++k) {
      bound.min[k] = std::min(bound.min[k], coords[k]);
      bound.max[k] = std::max(bound.max[k], coords[k]);
    }
    d.Add(ExactD<kDims>(point));
  }
  bound.min[kDims] = d.min();
  bound.max[kDims] = d.max();
  return Finish(bound, false, status);
}

template <int kDims>
Aabo<kDims> BoundAabb(const Aabb<kDims>& box, FitStatus* status) {
  if (box == Aabb<kDims>::Empty()) {
    return Finish(Aabo<kDims>::Empty(), false, status);
  }
  Aabo<kDims> bound;
  Point<kDims> low;
  Point<kDims> high;
  for (int k = 0; k < kDims; ++k) {
    if (box.min[k] > box.max[k]) {
      kernels::ThrowInvalid(
          "BoundAabb", "box",
          "min[" + std::to_string(k) + "] not above max[" + std::to_string(k) +
              "]",
          std::to_string(box.min[k]) + " and " + std::to_string(box.max[k]));
    }
    bound.min[k] = box.min[k];
    bound.max[k] = box.max[k];
    low[k] = box.min[k];
    high[k] = box.max[k];
  }
  if (!CanBeBounded<kDims>(low) || !CanBeBounded<kDims>(high)) {
    return Finish(bound, true, status);
  }
  bound.min[kDims] = RoundDown(ExactD<kDims>(high));
  bound.max[kDims] = RoundUp(ExactD<kDims>(low));
  return Finish(bound, false, status);
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
