// From a shape to the numbers that its kernels read, rounded so that what
// touches the real shape passes (docs/bvh.md).
#include "kernels/bvh/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernels/bvh/block.h"

namespace halfspace::detail {

float RoundedUp(double value) {
  return static_cast<float>(value + std::abs(value) * 0x1p-23 + 0x1p-149);
}

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

float RoundedDown(double value) { return -RoundedUp(-value); }

// At least the squared distance, as computed in any mode, of all points within
// the radius: of r (1 + 2^-19) + 2^-120, whatever of this is rounded off.
float SquaredLimit(float radius) {
  return radius * radius * (1 + 0x1.2p-18f) + 0x1p-124f;
}

}  // namespace

void MakeBall(const ShapePlanes& planes, const float* center, float radius,
              Ball& ball) {
  ball.dims = planes.dims;
  ball.max_plane = planes.has_max ? planes.axes : 0;
  ball.limit = SquaredLimit(radius);
  for (std::size_t k = 0; k < planes.dims; ++k) ball.center[k] = center[k];
  ball.d_axis = planes.axes > planes.dims ? planes.dims : 0;
  if (ball.d_axis == 0) return;
  // The sum of three floats errs by less than 2^-50 of their magnitudes.
  double width =
      std::sqrt(static_cast<double>(planes.dims)) * (1 + 0x1p-50) * radius;
  double d = 0;
  for (std::size_t k = 0; k < planes.dims; ++k) {
    d -= center[k];
    width += 0x1p-50 * std::abs(double{center[k]});
  }
  ball.d_min = RoundedDown(d - width);
  ball.d_max = RoundedUp(d + width);
}

void MakeLine(const ShapePlanes& planes, const double* origin,
              const double* direction, float max_t, float radius, Line& line) {
  double origins[4] = {};
  double directions[4] = {};
  double origin_size = 0;
  double direction_size = 0;
  for (std::size_t k = 0; k < planes.dims; ++k) {
    origins[k] = origin[k];
    directions[k] = direction[k];
    origins[planes.dims] -= origin[k];
    directions[planes.dims] -= direction[k];
    origin_size += std::abs(origin[k]);
    direction_size += std::abs(direction[k]);
  }
  line.entering = 0;
  line.max_t = max_t;
  LinePlane leaving[4];
  std::size_t leaving_count = 0;
  for (std::size_t k = 0; k < planes.axes; ++k) {
    const bool is_d = k == planes.dims;
    double width = radius;
    double rise = directions[k];
    double inverse = 1 / rise;
    if (is_d) {
      width *= std::sqrt(static_cast<double>(planes.dims)) * (1 + 0x1p-50);
      width += 0x1p-50 * (origin_size + direction_size * double{max_t});
    }
    if (std::abs(rise) < 0x1p-100) {
      // As if it did not move at all.
      if (rise != 0) width += std::abs(rise) * double{max_t};
      rise = 0;
      inverse = std::numeric_limits<double>::infinity();
    }
    width += 0x1p-50 * (std::abs(origins[k]) + width) + 0x1p-124;
    const float high = RoundedUp(origins[k] + width);
    const float low = RoundedDown(origins[k] - width);
    // What is no number tells nothing on this axis; neither does what a plane
    // could overflow with.
    if (!(std::abs(rise) < 0x1p120 && std::abs(high) < 0x1p100f &&
          std::abs(low) < 0x1p100f)) {
      continue;
    }
    const bool is_up = rise >= 0;
    const auto max = static_cast<std::uint32_t>(planes.axes + k);
    const auto min = static_cast<std::uint32_t>(k);
    const auto early = static_cast<float>(inverse * (1 - 0x1p-20));
    const auto late = static_cast<float>(inverse * (1 + 0x1p-20));
    const auto add = [&](bool is_max, bool enters) {
      const LinePlane plane = {is_max ? max : min, is_max ? low : high,
                               enters ? early : late};
      if (enters) {
        line.plane[line.entering++] = plane;
      } else {
        leaving[leaving_count++] = plane;
      }
    };
    add(false, is_up);
    if (planes.has_max) add(true, !is_up);
  }
  std::copy_n(leaving, leaving_count, line.plane + line.entering);
  line.planes = line.entering + leaving_count;
}

Front MakeFront(const ShapePlanes& planes, const float* normal, float offset) {
  // Of a simplex the sum is that of the corner which its minima make, times
  // what is left of the normal after so much of D.
  double most = 0;
  if (!planes.has_max) {
    for (std::size_t k = 0; k < planes.dims; ++k) {
      most = std::max(most, double{normal[k]});
    }
  }
  double factors[4] = {};
  double largest = 0;
  bool is_finite = std::isfinite(offset);
  for (std::size_t k = 0; k < planes.dims; ++k) {
    is_finite &= std::isfinite(normal[k]);
    factors[k] = normal[k] - most;
    largest = std::max(largest, std::abs(factors[k]));
  }
  const std::size_t factor_count = planes.dims + (planes.has_max ? 0 : 1);
  if (!planes.has_max) {
    factors[planes.dims] = -most;
    largest = std::max(largest, most);
  }
  // Finite planes cannot overflow with factors of 1/8 and less.
  const double scale =
      is_finite && largest > 0 ? std::ldexp(1.0, -4 - std::ilogb(largest)) : 1;
  const double scaled_offset = std::clamp(offset * scale, -0x1p126, 0x1p126);
  Front front{};
  front.offset =
      RoundedUp(scaled_offset + std::abs(scaled_offset) * 0x1p-19 + 0x1p-120);
  bool tells = is_finite && scaled_offset < 0x1p126;
  for (std::size_t k = 0; tells && k < factor_count; ++k) {
    const double factor = factors[k] * scale;
    if (factor == 0) continue;
    // What is lost of a subnormal factor could be anything, times a plane.
    tells = std::abs(factor) >= 0x1p-100;
    const auto min = static_cast<std::uint32_t>(k);
    const auto max = static_cast<std::uint32_t>(planes.axes + k);
    const bool is_max = planes.has_max && factor > 0;
    front.term[front.terms++] = {is_max ? max : min, is_max ? min : max,
                                 static_cast<float>(factor * (1 + 0x1p-19)),
                                 static_cast<float>(factor * (1 - 0x1p-19))};
  }
  if (!tells) front = {0, 0, {}};
  return front;
}

}  // namespace halfspace::detail
