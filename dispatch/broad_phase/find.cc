// Queries of a broad phase: the tree and the list of new bodies give
// candidates. Those whose bounds in the tree are not their own are tested
// again.
#include <bit>
#include <optional>

#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"

namespace halfspace::detail {
namespace {

template <std::size_t kAxes>
class Finder : public WalkIds {
 public:
  Finder(const BroadPhaseState& state, const BvhQueries& query,
         std::uint64_t mask, BodyFunction function, void* context)
      : WalkIds{{nullptr, nullptr, nullptr, nullptr, 0}, nullptr, &Take},
        state_(state),
        query_(query),
        mask_(mask),
        function_(function),
        context_(context) {}

  // An error handler may leave by longjmp, so a wrong query is refused before
  // Run() counts this reader into a version.
  void Find() {
    Walk walk{};
    walk.queries = query_.first;
    walk.query_count = 1;
    walk.ids = this;
    walk.mask = ~std::uint32_t{0};
    walk.is_urgent = true;
    walk.run = &Run;
    if (query_.kind != nullptr) {
      query_.kind->walk(state_.shape, query_, QueryOptions(), kCall, walk);
    } else {
      Run(walk, Kernels().find);
    }
  }

 private:
  static constexpr std::size_t kPlanes = 2 * kAxes;
  static constexpr const char* kCall = "BroadPhase::ForEach";

  const BvhKernels::OfPlanes& Kernels() const {
    return KernelsFor(state_.shape, Target(), kCall);
  }

  static void Run(const Walk& walk, WalkFunction find) {
    auto& self = static_cast<Finder&>(*walk.ids);
    const Held held(self.state_);
    const WithRacyReads reads;
    self.version_ = held.get();
    const Version& version = *held;
    self.queries_ = walk.queries;
    self.find_ = find;
    self.is_shape_ = find != self.Kernels().find;
    // The function may insert more.
    const std::size_t pending = version.PendingCount();
    for (std::size_t i = 0; i < pending; ++i) {
      if (!self.Add(version.Pending(i))) return;
    }
    if (!self.Flush()) return;
    self.is_first_ = true;
    Walk of_tree = walk;
    of_tree.levels = &version.tree.levels();
    if (of_tree.levels->level[0].size != 0) find(of_tree);
    self.Flush();
  }

  // Bodies of a leaf of the tree.
  static bool Take(WalkIds& ids, std::size_t block, std::uint64_t bits) {
    auto& self = static_cast<Finder&>(ids);
    const Version& version = *self.version_;
    const BvhLevels& levels = version.tree.levels();
    const std::size_t first = block * kBlockObjects;
    const auto id_at = [&](std::uint64_t some) {
      return levels
          .ids[first + static_cast<std::size_t>(std::countr_zero(some))];
    };
    // Masks belong to the bound of their record.
    const bool has_own = version.HasOwnBounds() && ~self.mask_ == 0;
    std::uint64_t others = 0;
    for (; bits != 0; bits &= bits - 1) {
      const std::uint32_t id = id_at(bits);
      float planes[kPlanes];
      const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
      if (has_own) {
        LoadPlanes(levels.level[0].Plane(block, 0) + lane, kPlanes, planes);
      }
      if (!has_own || !version.HasOwnBound(id)) {
        if (self.is_first_ && !self.is_shape_) {
          if (!self.Add(id)) return false;
          continue;
        }
        self.state_.bodies.Prefetch(id);
        others |= bits & (~bits + 1);
      } else {
        self.is_first_ = false;
        if (!self.Call(id, planes)) return self.Stop();
      }
    }
    for (; others != 0; others &= others - 1) {
      if (!self.Add(id_at(others))) return self.Stop();
    }
    if (!self.is_first_) return true;
    self.is_first_ = false;
    return self.Flush();
  }

  bool Stop() {
    if (leaf_) leaf_->Clear();
    return false;
  }

  [[gnu::noinline]] bool Add(std::uint32_t id) {
    Body body;
    const bool has_masks = ~mask_ != 0;
    if (!state_.bodies.ReadPlanes(id, kPlanes, body, has_masks) ||
        (has_masks && !HasMask(body.masks, mask_))) {
      return true;
    }
    if (is_shape_) {
      if (!leaf_) leaf_.emplace(kPlanes);
      leaf_->Add(id, body);
      return leaf_->size() < kBlockObjects || Flush();
    }
    if (!DoOverlap(body.planes, static_cast<const float*>(queries_), kAxes)) {
      return true;
    }
    is_first_ = false;
    return Call(id, body.planes);
  }

  bool Call(std::uint32_t id, const float* planes) {
    const WithoutRacyReads reads;
    return function_(context_, id, planes);
  }

  // Tests the bodies of the leaf, and calls the function for those that
  // survive.
  [[gnu::noinline]] bool Flush() {
    if (!leaf_ || leaf_->size() == 0) return true;
    std::uint32_t lanes[2 * kBlockObjects];
    WalkIds found{{lanes, lanes, lanes + kBlockObjects + 1, nullptr, 0},
                  nullptr};
    Walk walk{};
    walk.levels = &leaf_->Finish();
    walk.queries = queries_;
    walk.query_count = 1;
    walk.ids = &found;
    walk.mask = ~std::uint32_t{0};
    find_(walk);
    for (const std::uint32_t* lane = lanes; lane != found.next; ++lane) {
      float planes[kMostBodyPlanes];
      leaf_->PlanesOf(*lane, planes);
      if (!Call(leaf_->IdOf(*lane), planes)) return Stop();
    }
    leaf_->Clear();
    return true;
  }

  const BroadPhaseState& state_;
  const Version* version_ = nullptr;
  const BvhQueries& query_;
  std::uint64_t mask_;
  BodyFunction function_;
  void* context_;
  const void* queries_ = nullptr;  // as the kernel reads them
  WalkFunction find_ = nullptr;
  bool is_shape_ = false;          // and not a bound
  bool is_first_ = false;          // no body of the tree was found
  std::optional<ExactLeaf> leaf_;  // of shapes. It is large
};

}  // namespace

void BroadPhaseCore::ForEach(const BvhQueries& query, std::uint64_t mask,
                             BodyFunction function, void* context) const {
  WithAxes(state_->shape.axes, [&](auto axes) {
    Finder<decltype(axes)::value>(*state_, query, mask, function, context)
        .Find();
  });
}

}  // namespace halfspace::detail
