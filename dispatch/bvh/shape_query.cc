// Makes the numbers that the kernels of a query shape read. They are rounded so
// that every bound that touches the exact shape is found (docs/bvh.md).
#include "dispatch/bvh/shape_query.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>

#include "dispatch/outward.h"
#include "kernels/bvh/block.h"
#include "kernels/compiler.h"

namespace halfspace::detail {

namespace {

using dispatch::RoundUpLoosely;
float RoundDownLoosely(double value) { return -RoundUpLoosely(-value); }

// Returns the limit of squared distances. In any mode, a kernel computes at
// most ((1 + 2^-20) r + 2^-123)^2 for a point within the radius r. The limit is
// at least ((1 + 2^-19) r + 2^-120)^2 + 2^-125: the square of 1 + 2^-19 takes
// 2^-18 of the factor, and three roundings and the product of r and 2^-120 take
// less than the 2^-21 that are left. An overflow can be the greatest float, so
// a limit near it is infinite. docs/bvh.md has the proof.
float SquaredLimit(float radius) {
  const float limit = radius * radius * (1 + 0x1.2p-18f) + 0x1p-124f;
  if (limit >= 0x1.fffffp127f) return std::numeric_limits<float>::infinity();
  return limit;
}

float OutwardOffset(double scaled) {
  return RoundUpLoosely(scaled + std::abs(scaled) * 0x1p-19 + 0x1p-120);
}

// Returns false if the half-space rejects nothing with this offset.
bool SetOffset(double scaled, HalfSpaceTest& test) {
  const bool is_finite = std::isfinite(scaled);
  scaled = std::clamp(scaled, -0x1p126, 0x1p126);
  test.offset = OutwardOffset(scaled);
  return is_finite && scaled < 0x1p126;
}

}  // namespace

void MakeBall(const PlaneLayout& planes, const float* low, const float* high,
              float radius, Ball& ball) {
  ball.center.dims = planes.dims;
  ball.center.max_plane = planes.first_max;
  ball.limit = SquaredLimit(radius);
  for (std::size_t k = 0; k < planes.dims; ++k) {
    ball.center.low[k] = low[k];
    ball.center.high[k] = high[k];
  }
  ball.d_axis = planes.axes > planes.dims ? planes.dims : 0u;
  if (ball.d_axis == 0) return;
  // The error of the sum of three floats is less than 2^-50 of their
  // magnitudes.
  double width =
      std::sqrt(static_cast<double>(planes.dims)) * (1 + 0x1p-50) * radius;
  double least = 0;
  double most = 0;
  for (std::size_t k = 0; k < planes.dims; ++k) {
    least -= high[k];
    most -= low[k];
    width += 0x1p-50 * (std::abs(double{low[k]}) + std::abs(double{high[k]}));
  }
  ball.d_min = RoundDownLoosely(least - width);
  ball.d_max = RoundUpLoosely(most + width);
}

void MakeLine(const PlaneLayout& planes, const double* low, const double* high,
              const double* direction, float max_t, float radius, Line& line) {
  line.max_t = max_t;
  line.entering = planes.first_max;
  line.planes = planes.plane_count;
  std::size_t leaving = line.planes;
  std::size_t limiting = 0;
  const auto add_axis = [&](std::size_t k, double least, double most,
                            double rise, double width) {
    double speed = std::abs(rise);
    if (speed < 0x1p-100) {
      // It counts as not moving, and its way is added to its width.
      if (speed != 0) width += speed * double{max_t};
      rise = 0;
      speed = 0;
    }
    const double size = std::max(std::abs(least), std::abs(most)) + width;
    float inverse = 1 / static_cast<float>(rise);
    // If a number is NaN, or a plane could overflow, this axis rejects nothing:
    // the t of its planes is NaN.
    if (speed < 0x1p120 && size < 0x1p99 && least <= most) {
      ++limiting;
    } else {
      inverse = std::numeric_limits<float>::quiet_NaN();
    }
    width += size * 0x1p-23 + 0x1p-124;
    const auto above = static_cast<float>(most + width);
    const auto below = static_cast<float>(least - width);
    // No branch on the direction, because it would be mispredicted.
    const std::size_t is_down = std::signbit(rise) ? 1 : 0;
    const float margin = std::copysign(0x1p-20f, inverse);
    const LinePlane at_min = {static_cast<std::uint32_t>(k), above,
                              inverse * (1 - margin)};
    if (planes.has_max) {
      line.plane[k + is_down * planes.axes] = at_min;
      line.plane[k + (1 - is_down) * planes.axes] = {
          static_cast<std::uint32_t>(planes.axes + k), below,
          inverse * (1 + margin)};
    } else {
      leaving -= is_down;
      line.plane[is_down != 0 ? leaving : line.entering] = at_min;
      line.entering += 1 - is_down;
    }
  };
  for (std::size_t k = 0; k < planes.dims; ++k) {
    add_axis(k, low[k], high[k], direction[k], radius);
  }
  if (planes.axes > planes.dims) {
    double least = 0;
    double most = 0;
    double rise = 0;
    double size = 0;
    double reach = 0;
    for (std::size_t k = 0; k < planes.dims; ++k) {
      least -= high[k];
      most -= low[k];
      rise -= direction[k];
      size += std::max(std::abs(low[k]), std::abs(high[k]));
      reach += std::abs(direction[k]);
    }
    // If the direction nearly cancels out on D, its rounding error is at most
    // that at max_t. Otherwise the error is within the margins of t.
    if (std::abs(rise) < 0x1p-24 * reach) size += reach * double{max_t};
    const double root = std::sqrt(static_cast<double>(planes.dims));
    add_axis(planes.dims, least, most, rise,
             radius * root * (1 + 0x1p-50) + 0x1p-50 * size);
  }
  if (limiting == 0) line.entering = line.planes = 0;
}

namespace {

// Makes the test of TestOf() for boxes or spheres, in a third of the time.
// Returns false if a number is 0, tiny, huge or NaN.
template <std::size_t kDims, bool kIsSphere>
bool TrySetTest(const PlaneLayout& planes, const float* normal, float offset,
                HalfSpaceTest& test) {
  bool is_usual = std::abs(offset) <= 0x1p60f;
  float largest = 0;
  double squared = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    const float size = std::abs(normal[k]);
    is_usual &= size >= 0x1p-40f;
    is_usual &= size <= 0x1p40f;
    largest = std::max(largest, size);
    squared += double{size} * size;
  }
  if (!is_usual) return false;
  // A sphere reaches as far as its radius times the length of the normal.
  const double length =
      kIsSphere ? std::sqrt(squared) * (1 + 0x1p-50) : double{largest};
  constexpr std::uint64_t kOne = 1023;  // the exponent of 1
  const auto scale = kernels::BitCast<double>(
      (kOne - 4 - (kernels::BitCast<std::uint64_t>(length) >> 52) + kOne)
      << 52);
  test.terms = kDims + (kIsSphere ? 1 : 0);
  test.offset = OutwardOffset(offset * scale);
  for (std::size_t k = 0; k < kDims; ++k) {
    const float factor = normal[k] * static_cast<float>(scale);
    // No branch on the sign, because it would be mispredicted.
    const auto min = static_cast<std::uint32_t>(k);
    const std::uint32_t axes = kIsSphere ? 0 : planes.axes;
    const std::uint32_t up = axes * std::uint32_t{factor > 0};
    test.term[k] = {min + up, min + axes - up, factor * (1 + 0x1p-19f),
                    factor * (1 - 0x1p-19f)};
  }
  if constexpr (kIsSphere) {
    const double factor = length * scale;
    test.term[kDims] = {kDims, kDims,
                        static_cast<float>(factor * (1 + 0x1p-19)),
                        static_cast<float>(factor * (1 - 0x1p-19))};
  }
  return true;
}

// Without loops of unknown length, and without the terms that a box lacks: a
// list of six half-spaces takes half as long.
template <std::size_t kDims, bool kHasMax>
HalfSpaceTest TestOf(const PlaneLayout& planes, const float* normal,
                     float offset) {
  constexpr std::uint64_t kOne = 1023;  // the exponent of 1
  // A simplex has only minima, so the normal is written as a combination of the
  // axes with factors of at most 0: `normal[k] - most` for axis k, and `-most`
  // for D.
  const bool is_sphere = planes.kind == PlaneLayout::kSphere;
  double most = 0;
  double squared = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    if (!kHasMax && !is_sphere) {
      most = std::max(most, double{normal[k]});
    }
    squared += double{normal[k]} * normal[k];
  }
  constexpr std::size_t kFactors = kDims + (kHasMax ? 0 : 1);
  double factors[kFactors] = {};
  double largest = 0;
  bool is_finite = std::isfinite(offset);
  for (std::size_t k = 0; k < kDims; ++k) {
    is_finite &= std::isfinite(normal[k]);
    factors[k] = normal[k] - most;
    largest = std::max(largest, std::abs(factors[k]));
  }
  if constexpr (!kHasMax) {
    // A sphere reaches as far as its radius times the length of the normal.
    factors[kDims] = is_sphere ? std::sqrt(squared) * (1 + 0x1p-50) : -most;
    largest = std::max(largest, std::abs(factors[kDims]));
  }
  // The factors are scaled by a power of two to 1/8 or less, so that finite
  // planes cannot overflow.
  const double scale =
      is_finite && largest > 0
          ? kernels::BitCast<double>(
                (kOne - 4 - (kernels::BitCast<std::uint64_t>(largest) >> 52) +
                 kOne)
                << 52)
          : 1;
  HalfSpaceTest test{};
  bool tells = SetOffset(offset * scale, test) && is_finite;
  for (std::size_t k = 0; tells && k < kFactors; ++k) {
    const double factor = factors[k] * scale;
    if (factor == 0) continue;
    // The rounding error of a subnormal factor has no bound relative to its
    // product.
    tells = std::abs(factor) >= 0x1p-100;
    const auto min = static_cast<std::uint32_t>(k);
    const auto max = static_cast<std::uint32_t>(planes.axes + k);
    const bool is_max = kHasMax && factor > 0;
    test.term[test.terms++] = {is_max ? max : min,
                               is_max || is_sphere ? min : max,
                               static_cast<float>(factor * (1 + 0x1p-19)),
                               static_cast<float>(factor * (1 - 0x1p-19))};
  }
  if (!tells) test = {0, 0, {}};
  return test;
}

}  // namespace

void MakeHalfSpaceTest(const PlaneLayout& planes, const float* normal,
                       float offset, HalfSpaceTest& test) {
  const bool is_2d = planes.dims == 2;
  if (planes.has_max) {
    if ((is_2d ? TrySetTest<2, false> : TrySetTest<3, false>)(planes, normal,
                                                              offset, test)) {
      return;
    }
  } else if (planes.kind == PlaneLayout::kSphere) {
    if ((is_2d ? TrySetTest<2, true> : TrySetTest<3, true>)(planes, normal,
                                                            offset, test)) {
      return;
    }
  }
  const auto make = planes.has_max
                        ? (is_2d ? &TestOf<2, true> : &TestOf<3, true>)
                        : (is_2d ? &TestOf<2, false> : &TestOf<3, false>);
  // Constructed in place, because a copy would wait for the stores.
  new (&test) HalfSpaceTest(make(planes, normal, offset));
}

namespace {

// Moves a side of the box, if the half-space is axis-aligned. The box begins as
// all of space.
bool AddToBox(const float* normal, float offset, std::size_t dims,
              HalfSpaceTests& tests) {
  std::size_t axis = dims;
  for (std::size_t k = 0; k < dims; ++k) {
    if (normal[k] == 0) continue;
    if (axis != dims) return false;
    axis = k;
  }
  if (axis == dims || !std::isfinite(normal[axis]) || !std::isfinite(offset)) {
    return false;
  }
  // Rounded outward. A side beyond 2^127 rejects nothing on its inner side, and
  // is moved to 2^127 on its outer side.
  const double side = -double{offset} / normal[axis];
  if (normal[axis] < 0) {
    if (side >= 0x1p127) return true;
    tests.high[axis] =
        std::min(tests.high[axis], RoundUpLoosely(std::max(side, -0x1p127)));
  } else {
    if (side <= -0x1p127) return true;
    tests.low[axis] =
        std::max(tests.low[axis], RoundDownLoosely(std::min(side, 0x1p127)));
  }
  return true;
}

}  // namespace

void MakeHalfSpaceTests(const PlaneLayout& planes, const float* half_spaces,
                        std::size_t count, HalfSpaceTests& tests) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const bool is_sphere = planes.kind == PlaneLayout::kSphere;
  tests.box_dims = 0;
  tests.max_plane = planes.first_max;
  tests.count = 0;
  for (std::size_t k = 0; k < planes.dims; ++k) {
    tests.low[k] = -kInf;
    tests.high[k] = kInf;
  }
  for (std::size_t f = 0; f < count; ++f) {
    const float* const normal = half_spaces + f * (planes.dims + 1u);
    const float offset = normal[planes.dims];
    if ((planes.has_max || is_sphere) &&
        AddToBox(normal, offset, planes.dims, tests)) {
      tests.box_dims = planes.dims;
    } else {
      MakeHalfSpaceTest(planes, normal, offset, tests.test[tests.count++]);
    }
  }
}

template <std::size_t kDims>
void MakeHalfSpaceTests(const PlaneLayout& planes, const float* normal,
                        float offset, float opposite_offset,
                        HalfSpaceTest* two) {
  constexpr double kScale = 0x1p-4;
  bool tells = SetOffset(offset * kScale, two[0]);
  bool opposite_tells = SetOffset(opposite_offset * kScale, two[1]);
  std::size_t terms = 0;
  for (std::size_t k = 0; k < kDims; ++k) {
    const double factor = normal[k] * kScale;
    if (factor == 0) continue;
    // Also for NaN.
    if (!(std::abs(factor) >= 0x1p-100)) tells = opposite_tells = false;
    const auto min = static_cast<std::uint32_t>(k);
    const auto max = static_cast<std::uint32_t>(planes.axes + k);
    const std::uint32_t plane = factor > 0 ? max : min;
    const std::uint32_t opposite = min + max - plane;
    const auto more = static_cast<float>(factor * (1 + 0x1p-19));
    const auto less = static_cast<float>(factor * (1 - 0x1p-19));
    two[0].term[terms] = {plane, opposite, more, less};
    two[1].term[terms++] = {opposite, plane, -more, -less};
  }
  two[0].terms = tells ? terms : 0;
  two[1].terms = opposite_tells ? terms : 0;
  if (!tells) two[0].offset = 0;
  if (!opposite_tells) two[1].offset = 0;
}

template void MakeHalfSpaceTests<2>(const PlaneLayout&, const float*, float,
                                    float, HalfSpaceTest*);
template void MakeHalfSpaceTests<3>(const PlaneLayout&, const float*, float,
                                    float, HalfSpaceTest*);

}  // namespace halfspace::detail
