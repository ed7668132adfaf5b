// The pairs of a broad phase.
#include "dispatch/bvh/pairs.h"

#include <cstdint>

#include "dispatch/broad_phase/state.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::detail {
namespace {

// Keeps the pairs that the masks and the filter of a broad phase keep.
class KeptPairs {
 public:
  explicit KeptPairs(const BroadPhaseState& state) : state_(state) {}

  PairListFilter filter() {
    const bool has_masks = state_.tree.levels().level[0].masks != nullptr ||
                           !state_.collides_with.empty();
    if (!has_masks && state_.options.filter.keep == nullptr) return {};
    return {[](void* self, Span<IdPair> pairs) {
              return static_cast<const KeptPairs*>(self)->Keep(pairs);
            },
            this};
  }

 private:
  std::size_t Keep(Span<IdPair> pairs) const {
    const PairFilter& filter = state_.options.filter;
    std::size_t count = 0;
    for (const IdPair& pair : pairs) {
      const BodyMasks a = state_.MasksOf(pair.a);
      const BodyMasks b = state_.MasksOf(pair.b);
      bool is_kept = (a.category & b.collides_with) != 0 &&
                     (b.category & a.collides_with) != 0;
      if (filter.keep != nullptr) {
        is_kept = filter.keep(filter.context, pair.a, pair.b, is_kept);
      }
      pairs[count] = pair;
      count += is_kept ? 1 : 0;
    }
    return count;
  }

  const BroadPhaseState& state_;
};

}  // namespace

void BroadPhaseCore::UpdatePairs(const BvhPairKernels* kernels,
                                 const Runner& run) {
  BroadPhaseState& state = *state_;
  Changing changing(state, Changing::kAllMarked);
  state.Flush();
  // Queries may read the tree during the search.
  changing.ShowTree();
  const bool is_of_some =
      IsSmallSet(state.records.Count(Records::kForPairs), state.tree.size());
  CallMemory of_call(state.options.memory);
  const BlockVector<std::uint32_t> changed =
      is_of_some ? state.IdsOf(Records::kForPairs, of_call.resource())
                 : BlockVector<std::uint32_t>();
  const Span<const std::uint32_t> set(changed.data(), changed.size());
  KeptPairs kept(state);
  state.events.Update(
      {kernels, &state.tree, nullptr, is_of_some ? &set : nullptr},
      {.run = run}, kept.filter());
  state.records.Clear(Records::kForPairs);
}

const PairEventsCore& BroadPhaseCore::events() const { return state_->events; }

}  // namespace halfspace::detail
