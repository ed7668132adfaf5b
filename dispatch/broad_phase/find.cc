// Queries of a broad phase: the tree and the list of new bodies give
// candidates, which are tested again by their own bounds.
#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"

namespace halfspace::detail {
namespace {

class Finder {
 public:
  Finder(const BroadPhaseState& state, const Version& version,
         const BvhQueries& query, std::uint64_t mask, BodyFunction function,
         void* context)
      : state_(state),
        version_(version),
        query_(query),
        kernels_(KernelsFor(state.shape, Target(), kCall)),
        mask_(mask),
        function_(function),
        context_(context),
        leaf_(state.planes()) {}

  // The name of the call in messages.
  static constexpr const char* kCall = "BroadPhase::ForEach";

  // Throws unless the query is right.
  static void Check(const BvhTree& tree, const BvhQueries& query) {
    if (query.kind == nullptr) return;
    const BvhLevels nothing;
    Walk walk{};
    walk.levels = &nothing;
    query.kind->walk(tree, query, QueryOptions(), kCall, walk);
  }

  void Find() {
    for (std::size_t i = 0; i < version_.PendingCount(); ++i) {
      if (!Add(version_.Pending(i))) return;
    }
    if (!Flush()) return;
    BvhForEach(
        version_.tree, query_,
        [](void* finder, Span<const std::uint32_t> ids) {
          auto& self = *static_cast<Finder*>(finder);
          for (const std::uint32_t id : ids) {
            if (!self.Add(id)) return false;
          }
          return self.Flush();
        },
        this, QueryOptions());
  }

 private:
  bool Add(std::uint32_t id) {
    Body body;
    if (!state_.bodies.Read(id, body) || !HasMask(body.masks, mask_)) {
      return true;
    }
    leaf_.Add(id, body);
    return leaf_.size() < kBlockObjects || Flush();
  }

  // Tests the bodies of the leaf, and calls the function for those that
  // survive.
  bool Flush() {
    if (leaf_.size() == 0) return true;
    std::uint32_t lanes[2 * kBlockObjects];
    WalkIds found{lanes, lanes, lanes + kBlockObjects + 1, nullptr, 0, nullptr};
    Walk walk{};
    walk.levels = &leaf_.Finish();
    walk.queries = query_.first;
    walk.query_count = 1;
    walk.ids = &found;
    walk.mask = ~std::uint32_t{0};
    if (query_.kind != nullptr) {
      query_.kind->walk(version_.tree, query_, QueryOptions(), kCall, walk);
    } else {
      kernels_.find(walk);
    }
    for (const std::uint32_t* lane = lanes; lane != found.next; ++lane) {
      float planes[kMostBodyPlanes];
      leaf_.PlanesOf(*lane, planes);
      const WithoutRacyReads reads;
      if (!function_(context_, leaf_.IdOf(*lane), planes)) return false;
    }
    leaf_.Clear();
    return true;
  }

  const BroadPhaseState& state_;
  const Version& version_;
  const BvhQueries& query_;
  const BvhKernels::OfPlanes& kernels_;
  std::uint64_t mask_;
  BodyFunction function_;
  void* context_;
  ExactLeaf leaf_;
};

}  // namespace

void BroadPhaseCore::ForEach(const BvhQueries& query, std::uint64_t mask,
                             BodyFunction function, void* context) const {
  const BvhTree no_tree(state_->shape, MemoryResource());
  Finder::Check(no_tree, query);
  const Held version(*state_);
  const WithRacyReads reads;
  Finder(*state_, *version, query, mask, function, context).Find();
}

}  // namespace halfspace::detail
