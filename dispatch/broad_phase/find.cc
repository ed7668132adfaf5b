// Queries of a broad phase: the tree and the list of new bodies give
// candidates, which are tested again by their own bounds.
#include <cmath>

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
        mask_(mask),
        function_(function),
        context_(context),
        leaf_(state.planes()) {}

  // The name of the call in messages.
  static constexpr const char* kCall = "BroadPhase::ForEach";

  // Throws unless the query, of a shape, is right.
  static void Check(const BvhShape& shape, const BvhQueries& query) {
    const BvhTree nothing(shape, MemoryResource());
    Walk walk{};
    walk.levels = &nothing.levels();
    query.kind->walk(nothing, query, QueryOptions(), kCall, walk);
  }

  void Find() {
    // The function may insert more.
    const std::size_t pending = version_.PendingCount();
    for (std::size_t i = 0; i < pending; ++i) {
      if (!Add(version_.Pending(i))) return;
    }
    if (!Flush()) return;
    BvhForEach(
        version_.tree, query_,
        [](void* finder, Span<const std::uint32_t> ids) {
          auto& self = *static_cast<Finder*>(finder);
          for (const std::uint32_t id : ids) self.state_.bodies.Prefetch(id);
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
    if (query_.kind != nullptr) {
      leaf_.Add(id, body);
      return leaf_.size() < kBlockObjects || Flush();
    }
    return !Touches(body.planes) || Call(id, body.planes);
  }

  // As the kernels test a bound.
  bool Touches(const float* planes) const {
    const std::size_t axes = state_.shape.axes;
    const auto* const query = static_cast<const float*>(query_.first);
    bool is_apart = false;
    for (std::size_t k = 0; k < axes; ++k) {
      is_apart |= std::isgreater(planes[k], query[axes + k]);
      is_apart |= std::isgreater(query[k], planes[axes + k]);
    }
    return !is_apart;
  }

  bool Call(std::uint32_t id, const float* planes) {
    const WithoutRacyReads reads;
    return function_(context_, id, planes);
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
    query_.kind->walk(version_.tree, query_, QueryOptions(), kCall, walk);
    for (const std::uint32_t* lane = lanes; lane != found.next; ++lane) {
      float planes[kMostBodyPlanes];
      leaf_.PlanesOf(*lane, planes);
      if (!Call(leaf_.IdOf(*lane), planes)) return false;
    }
    leaf_.Clear();
    return true;
  }

  const BroadPhaseState& state_;
  const Version& version_;
  const BvhQueries& query_;
  std::uint64_t mask_;
  BodyFunction function_;
  void* context_;
  ExactLeaf leaf_;
};

}  // namespace

void BroadPhaseCore::ForEach(const BvhQueries& query, std::uint64_t mask,
                             BodyFunction function, void* context) const {
  if (query.kind != nullptr) Finder::Check(state_->shape, query);
  const Held version(*state_);
  const WithRacyReads reads;
  Finder(*state_, *version, query, mask, function, context).Find();
}

}  // namespace halfspace::detail
