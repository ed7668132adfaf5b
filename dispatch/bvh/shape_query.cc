// Makes the numbers that the kernels of a query shape read. They are rounded so
// that every bound that touches the exact shape is found (docs/bvh.md).
#include "dispatch/bvh/shape_query.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dispatch/outward.h"
#include "kernels/bvh/kernel_table.h"
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

// Of others, a factor might be infinite.
bool IsUsual(const float* normal, float offset, std::size_t dims) {
  bool is_usual = std::isfinite(offset);
  for (std::size_t k = 0; k < dims; ++k) {
    is_usual &= std::abs(normal[k]) <= 0x1p126f;
  }
  return is_usual;
}

}  // namespace

void MakeHalfSpaceTest(const PlaneLayout& planes, const float* normal,
                       float offset, HalfSpaceTest& test) {
  const bool is_usual = IsUsual(normal, offset, planes.dims);
  test.offset = is_usual ? offset : 0;
  test.terms = 0;
  if (!is_usual) return;
  std::uint32_t terms = 0;
  if (planes.has_max) {
    const std::uint32_t axes = planes.axes;
    for (std::uint32_t k = 0; k < planes.dims; ++k) {
      if (normal[k] == 0) continue;
      // No branch on the sign, because it would be mispredicted.
      const std::uint32_t up = axes * std::uint32_t{normal[k] > 0};
      test.term[terms++] = {k + up, k + axes - up, normal[k], normal[k]};
    }
  } else if (planes.kind == PlaneLayout::kSphere) {
    double squared = 0;
    for (std::uint32_t k = 0; k < planes.dims; ++k) {
      squared += double{normal[k]} * normal[k];
      test.term[terms++] = {k, k, normal[k], normal[k]};
    }
    if (squared == 0) return;
    // A sphere reaches as far as its radius times the length of the normal.
    const float length = RoundUpLoosely(std::sqrt(squared) * (1 + 0x1p-50));
    test.term[terms] = {terms, terms, length, length};
    ++terms;
  } else {
    // A simplex has only minima, so the normal is written as a combination of
    // the axes with factors of at most 0: `normal[k] - most` for axis k, and
    // `-most` for D.
    double most = 0;
    for (std::size_t k = 0; k < planes.dims; ++k) {
      most = std::max(most, double{normal[k]});
    }
    for (std::uint32_t k = 0; k <= planes.dims; ++k) {
      const double factor = (k < planes.dims ? normal[k] : 0) - most;
      if (factor == 0) continue;
      test.term[terms++] = {k, k, RoundUpLoosely(factor),
                            RoundDownLoosely(factor)};
    }
  }
  test.terms = terms;
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
  if (axis == dims || !IsUsual(normal, offset, dims)) return false;
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

}  // namespace halfspace::detail
