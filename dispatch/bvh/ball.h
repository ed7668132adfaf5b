// The time at which a moving ball first touches a bound.
#ifndef HALFSPACE_DISPATCH_BVH_BALL_H_
#define HALFSPACE_DISPATCH_BVH_BALL_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "dispatch/outward.h"
#include "halfspace/detail/bvh.h"
#include "kernels/bvh/shape_query.h"

namespace halfspace::detail {

// A cast of a ball. The kernels cast the box around the ball, and each bound
// that the box touches is tested here. Called in the default floating-point
// mode.
class BallCast {
 public:
  // `line` is the line of the box. It must not change.
  BallCast(const PlaneLayout& layout, const LineCast& cast, const Line& line)
      : layout_(layout), cast_(cast), line_(line) {}

  // Infinite if the ball does not touch the bound. `planes` has the bound's
  // value on plane p at p * kBlockObjects.
  float EntryOf(const float* planes) const {
    const auto at = [&](std::size_t p) {
      const LinePlane& plane = line_.plane[p];
      return (planes[plane.plane * kBlockObjects] - plane.offset) *
             plane.inverse;
    };
    float enter = 0;
    float exit = line_.max_t;
    std::size_t p = 0;
    for (; p < line_.entering; ++p) {
      const float t = at(p);
      enter = t > enter ? t : enter;
    }
    for (; p < line_.planes; ++p) {
      const float t = at(p);
      exit = t < exit ? t : exit;
    }
    exit = exit + kApartOnLine;
    if (!(enter <= exit)) return std::numeric_limits<float>::infinity();
    return EntryFrom(planes, ReportedTime(enter), exit);
  }

 private:
  // Returns the t from `enter` to `exit` at which the ball first touches the
  // box that the coordinate axes of the bound make, or infinity. The t is not
  // above the exact one, because the squared distance is rounded down. Between
  // the times at which the center passes a plane, the squared distance is a
  // quadratic function of t.
  float EntryFrom(const float* planes, float enter, float exit) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    struct Axis {
      double from, to;  // times between which the center is between the planes
      double before, after;  // center minus the plane that it passes
      double speed;
    };
    Axis axes[3];
    std::size_t moving = 0;
    double resting = 0;  // the constant part of the squared distance
    for (std::size_t k = 0; k < layout_.dims; ++k) {
      const double center = cast_.low[k];
      const double speed = cast_.direction[k];
      double above = center - planes[k * kBlockObjects];
      double below = layout_.has_max
                         ? center - planes[(layout_.axes + k) * kBlockObjects]
                         : -kInfinity;
      // A NaN, or an infinity on the wrong side, limits nothing.
      if (!std::isfinite(center) || !std::isfinite(speed)) continue;
      if (!(above > -kInfinity)) above = kInfinity;
      if (!(below < kInfinity)) below = -kInfinity;
      if (above < below) continue;  // inverted
      if (speed == 0) {
        const double gap = above < 0 ? above : below > 0 ? below : 0;
        resting += gap * gap;
        continue;
      }
      Axis& axis = axes[moving++];
      axis.before = speed > 0 ? above : below;
      axis.after = speed > 0 ? below : above;
      axis.from = -axis.before / speed;
      axis.to = -axis.after / speed;
      axis.from -= std::abs(axis.from) * 0x1p-50;
      axis.to += std::abs(axis.to) * 0x1p-50;
      axis.speed = speed;
    }
    const double squared_radius = double{cast_.radius} * cast_.radius;
    double begin = enter;
    for (;;) {
      double end = exit;
      double a = 0;
      double b = 0;
      double c = resting;
      for (std::size_t k = 0; k < moving; ++k) {
        const Axis& axis = axes[k];
        if (begin < axis.from) {
          end = std::min(end, axis.from);
        } else if (begin < axis.to) {
          end = std::min(end, axis.to);
          continue;
        }
        const double gap = begin < axis.from ? axis.before : axis.after;
        a += axis.speed * axis.speed;
        b += axis.speed * gap;
        c += gap * gap;
      }
      const double size = c + squared_radius;
      const double excess = c - squared_radius - size * 0x1p-46;
      const double squared = b * b - a * excess;
      double t = kInfinity;
      if (a == 0) {
        if (excess <= 0) t = begin;
      } else if (squared >= 0) {
        const double root = std::sqrt(squared) + std::sqrt(a * size) * 0x1p-46;
        if (root - b >= a * begin) t = std::max(begin, (-b - root) / a);
      }
      if (t <= end) return std::max(enter, -dispatch::RoundUpLoosely(-t));
      if (!(end < exit)) return std::numeric_limits<float>::infinity();
      begin = end;
    }
  }

  const PlaneLayout& layout_;
  const LineCast& cast_;
  const Line& line_;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_BALL_H_
