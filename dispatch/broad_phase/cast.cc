// Casts through a broad phase. Bodies whose bounds in the tree are not their
// own are cast at again.
#include "dispatch/bvh/cast.h"

#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "kernels/exact/default_fp_mode.h"

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
    kernels::CallApart([&] {
      LineSearch search;
      if (!MakeCastLine(state_.shape, cast, search.line)) return;
      line_ = &search.line;
      limit_ = search.line.max_t;
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
    Body body;
    LoadPlanes(of_tree, self.state_.planes(), body.planes);
    if (~self.mask_ != 0 || !self.version_.HasOwnBound(id)) {
      return self.Cast(id);
    }
    return self.Call(id, t, body.planes);
  }

  float Cast(std::uint32_t id) {
    Body body;
    const bool has_masks = ~mask_ != 0;
    if (!state_.bodies.Read(id, body, has_masks) ||
        (has_masks && !HasMask(body.masks, mask_))) {
      return limit_;
    }
    const float t = EntryOf(body.planes);
    return t < 0 ? limit_ : Call(id, t, body.planes);
  }

  // As the kernels do. Negative if the line does not enter the bound up to the
  // limit.
  float EntryOf(const float* planes) const {
    const auto at = [&](std::size_t p) {
      const LinePlane& plane = line_->plane[p];
      return (planes[plane.plane] - plane.offset) * plane.inverse;
    };
    float enter = 0;
    float exit = limit_;
    std::size_t p = 0;
    for (; p < line_->entering; ++p) {
      const float t = at(p);
      enter = t > enter ? t : enter;
    }
    for (; p < line_->planes; ++p) {
      const float t = at(p);
      exit = t < exit ? t : exit;
    }
    return enter <= exit + kApartOnLine ? enter : -1;
  }

  float Call(std::uint32_t id, float t, const float* planes) {
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
  kernels::DefaultFpMode mode_;
  const Line* line_ = nullptr;
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
