// The pairs of a broad phase.
#include <cstdint>
#include <vector>

#include "dispatch/broad_phase/state.h"
#include "halfspace/bvh_pairs.h"

namespace halfspace::detail {
namespace {

// With more changes, a search of all pairs of the tree takes less time.
constexpr std::size_t kShareOfSet = 4;

// The masks and the filter of a broad phase.
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
  const Changing changing("BroadPhase::UpdatePairs", state);
  state.Flush();
  std::size_t count = 0;
  state.records.ForEachChanged([&](std::uint32_t) { ++count; });
  std::vector<std::uint32_t, BlockAllocator<std::uint32_t>> changed(
      BlockAllocator<std::uint32_t>(state.options.memory));
  const bool is_of_some = kShareOfSet * count < state.tree.size();
  if (is_of_some) {
    changed.reserve(count);
    state.records.ForEachChanged(
        [&](std::uint32_t id) { changed.push_back(id); });
  }
  const Span<const std::uint32_t> set(changed.data(), changed.size());
  PairEventOptions options;
  options.run = run;
  KeptPairs kept(state);
  state.events.Update(
      {kernels, &state.tree, nullptr, is_of_some ? &set : nullptr}, options,
      kept.filter());
  state.records.ClearChanged();
}

const PairEventsCore& BroadPhaseCore::events() const { return state_->events; }

}  // namespace halfspace::detail
