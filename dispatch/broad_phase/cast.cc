// Casts through a broad phase. What a ray or a box enters in the tree is cast
// at again by its own bound.
#include "dispatch/bvh/cast.h"

#include <limits>

#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "kernels/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

class BodyCaster {
 public:
  BodyCaster(const BroadPhaseState& state, const BvhNearestKernels& kernels,
             std::uint64_t mask, BodyCastFunction function, void* context)
      : state_(state),
        kernels_(kernels),
        mask_(mask),
        function_(function),
        context_(context),
        leaf_(state.planes()) {}

  void Run(const Version& version, const LineCast& cast) {
    kernels::CallApart([&] {
      LineSearch search;
      if (!MakeCastLine(state_.shape, cast, exact_.line)) return;
      exact_.mask = search.mask = ~std::uint32_t{0};
      exact_.function = &TakeExact;
      exact_.context = search.context = this;
      search.function = &Take;
      // The function may insert more.
      const std::size_t pending = version.PendingCount();
      for (std::size_t i = 0; i < pending; ++i) {
        if (Cast(version.Pending(i)) < 0) return;
      }
      if (version.tree.ids().empty()) return;
      search.levels = &version.tree.levels();
      search.line = exact_.line;
      kernels_.cast(search);
    });
  }

 private:
  static float Take(void* caster, std::uint32_t id, float /*t*/,
                    const float* /*planes*/) {
    return static_cast<BodyCaster*>(caster)->Cast(id);
  }

  // Returns the limit.
  float Cast(std::uint32_t id) {
    Body body;
    if (state_.bodies.Read(id, body) && HasMask(body.masks, mask_)) {
      leaf_.Clear();
      leaf_.Add(id, body);
      exact_.levels = &leaf_.Finish();
      body_ = &body;
      kernels_.cast(exact_);
    }
    return limit_;
  }

  static float TakeExact(void* caster, std::uint32_t lane, float t,
                         const float* /*planes*/) {
    auto& self = *static_cast<BodyCaster*>(caster);
    const float limit = self.mode_.Outside([&] {
      const WithoutRacyReads reads;
      return self.function_(self.context_, self.leaf_.IdOf(lane), t,
                            self.body_->planes);
    });
    if (limit < self.limit_) self.limit_ = limit;
    if (limit < self.exact_.line.max_t) self.exact_.line.max_t = limit;
    return self.limit_;
  }

  const BroadPhaseState& state_;
  const BvhNearestKernels& kernels_;
  std::uint64_t mask_;
  BodyCastFunction function_;
  void* context_;
  kernels::DefaultFpMode mode_;
  float limit_ = std::numeric_limits<float>::infinity();
  LineSearch exact_;
  const Body* body_ = nullptr;
  ExactLeaf leaf_;
};

}  // namespace

void BroadPhaseCore::ForEachCast(const LineCast& cast, std::uint64_t mask,
                                 BodyCastFunction function,
                                 void* context) const {
  const BvhNearestKernels& kernels = CheckCast(cast, Target());
  const Held version(*state_);
  const WithRacyReads reads;
  BodyCaster(*state_, kernels, mask, function, context).Run(*version, cast);
}

}  // namespace halfspace::detail
