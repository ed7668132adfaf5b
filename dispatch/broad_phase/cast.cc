// Casts through a broad phase. Bodies whose bounds in the tree are not their
// own are cast at again.
#include "dispatch/bvh/cast.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "dispatch/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

class BodyCaster {
 public:
  BodyCaster(const BroadPhaseState& state, const Version& version,
             std::uint64_t mask, BodyCastFunction function, void* context)
      : state_(state),
        version_(version),
        mask_(mask),
        function_(function),
        context_(context) {}

  void Run(const BvhNearestKernels& kernels, const LineCast& cast) {
    dispatch::CallApart([&] {
      LineSearch search;
      if (!MakeCastLine(state_.shape, cast, search.line)) return;
      line_ = &search.line;
      limit_ = max_t_ = search.line.max_t;
      // A radius of 0 is a ray or a box.
      cast_ = &cast;
      is_ball_ = cast.radius > 0;
      // The function may insert more.
      const std::size_t pending = version_.PendingCount();
      for (std::size_t i = 0; i < pending; ++i) {
        if (Cast(version_.Pending(i)) < 0) return;
      }
      if (version_.tree.ids().empty()) return;
      search.levels = &version_.tree.levels();
      search.mask = ~std::uint32_t{0};
      search.function = &Take;
      search.context = this;
      search.line.max_t = limit_;
      kernels.cast(search);
    });
  }

 private:
  // Returns the limit.
  static float Take(void* caster, std::uint32_t id, float t,
                    const float* of_tree) {
    auto& self = *static_cast<BodyCaster*>(caster);
    if (~self.mask_ != 0 || !self.version_.HasOwnBounds()) return self.Cast(id);
    float planes[kMostBodyPlanes];
    LoadPlanes(of_tree, self.state_.planes(), planes);
    if (!self.version_.HasOwnBound(id)) return self.Cast(id);
    return self.is_ball_ ? self.CastAt(id, planes) : self.Call(id, t, planes);
  }

  float Cast(std::uint32_t id) {
    Body body;
    const bool has_masks = ~mask_ != 0;
    if (!state_.bodies.Read(id, body, has_masks) ||
        (has_masks && !HasMask(body.masks, mask_))) {
      return limit_;
    }
    return CastAt(id, body.planes);
  }

  float CastAt(std::uint32_t id, const float* planes) {
    const float t = EntryOf(planes);
    return t <= limit_ + kApartOnLine ? Call(id, t, planes) : limit_;
  }

  // As the kernels do. Infinite if the line does not enter the bound up to the
  // limit.
  float EntryOf(const float* planes) const {
    const auto at = [&](std::size_t p) {
      const LinePlane& plane = line_->plane[p];
      return (planes[plane.plane] - plane.offset) * plane.inverse;
    };
    float enter = 0;
    // BallEntryOf() rounds the t of a ball down. CastAt() compares the result
    // with the limit.
    float exit = is_ball_ ? max_t_ : limit_;
    std::size_t p = 0;
    for (; p < line_->entering; ++p) {
      const float t = at(p);
      enter = t > enter ? t : enter;
    }
    for (; p < line_->planes; ++p) {
      const float t = at(p);
      exit = t < exit ? t : exit;
    }
    exit = exit + kApartOnLine;
    if (!(enter <= exit)) return std::numeric_limits<float>::infinity();
    return is_ball_ ? BallEntryOf(planes, ReportedTime(enter), exit) : enter;
  }

  // Returns the t from `enter` to `exit` at which the ball first touches the
  // box of the first axes, or infinity. The t is at most the exact one, because
  // the squared distance is rounded down. Between the times at which the center
  // passes a plane, this distance is a quadratic in t.
  float BallEntryOf(const float* planes, float enter, float exit) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    struct Axis {
      double from, to;       // when the center is between the planes
      double before, after;  // the center less the plane that it passes
      double speed;
    };
    Axis axes[3];
    std::size_t moving = 0;
    double resting = 0;  // the part of the squared distance that never changes
    for (std::size_t k = 0; k < state_.shape.dims; ++k) {
      const double center = cast_->low[k];
      const double speed = cast_->direction[k];
      double above = center - planes[k];
      double below = center - planes[state_.shape.axes + k];
      // NaNs and infinities on the wrong side limit nothing.
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
    const double squared_radius = double{cast_->radius} * cast_->radius;
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
      if (t <= end) return std::max(enter, -RoundedUp(-t));
      if (!(end < exit)) return std::numeric_limits<float>::infinity();
      begin = end;
    }
  }

  float Call(std::uint32_t id, float t, const float* planes) {
    t = ReportedTime(t);
    const float limit = mode_.Outside([&] {
      const WithoutRacyReads reads;
      return function_(context_, id, t, planes);
    });
    if (limit < limit_) limit_ = limit;
    return limit_;
  }

  const BroadPhaseState& state_;
  const Version& version_;
  std::uint64_t mask_;
  BodyCastFunction function_;
  void* context_;
  dispatch::DefaultFpMode mode_;
  const Line* line_ = nullptr;
  const LineCast* cast_ = nullptr;
  bool is_ball_ = false;
  float max_t_ = 0;
  float limit_ = 0;
};

}  // namespace

void BroadPhaseCore::ForEachCast(const LineCast& cast, std::uint64_t mask,
                                 BodyCastFunction function,
                                 void* context) const {
  const BvhNearestKernels& kernels = CheckCast(cast, Target());
  const Held version(*state_);
  const WithRacyReads reads;
  BodyCaster(*state_, *version, mask, function, context).Run(kernels, cast);
}

}  // namespace halfspace::detail
