// A query of a broad phase is a query of its tree. If some bodies are late,
// the frequent ones leave them out and test them by themselves, and the others
// search a copy of the tree that has their bounds.
#include <algorithm>
#include <cstring>
#include <tuple>
#include <type_traits>

#include "dispatch/broad_phase/late.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/errors/error.h"
#include "dispatch/sink.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"
#include "kernels/bvh/block.h"

namespace halfspace::detail {
namespace {

using IdSink = dispatch::Sink<WalkIds, std::uint32_t, 512>;

// Calls exact(tree) if the tree has all bounds, and late(reading) if not. A
// handler of errors may leave by longjmp, so with one the arguments are checked
// before the lock is taken.
template <typename Exact, typename Late>
auto Ask(BroadPhaseState& state, const Exact& exact, const Late& late) {
  if (dispatch::HasErrorHandler()) exact(state.nothing);
  const Reading reading(state);
  return reading.is_exact() ? exact(state.tree) : late(reading);
}

// With a copy of the tree if bodies are late.
template <typename Exact>
auto AskCopy(BroadPhaseState& state, const Exact& exact) {
  return Ask(state, exact, [&](const Reading& reading) {
    BvhTree copy(state.tree, state.options.memory);
    state.records.ForEachMarked([&](std::uint32_t id) {
      float planes[kMostBodyPlanes];
      if (reading.IsLate(id) && state.records.Read(id, planes)) {
        copy.Set(id, Span<const float>(planes, state.planes()));
      }
      return true;
    });
    return exact(copy);
  });
}

// Calls search(tree, ids, options). The tree without bodies has no ids, and so
// these are checked apart.
template <typename Search>
auto AskPairs(BroadPhaseState& state, const char* call,
              Span<const std::uint32_t> ids, const PairOptions& options,
              const Search& search) {
  state.CheckBodies(call, ids);
  return AskCopy(state, [&](const BvhTree& tree) {
    const std::size_t wanted = options.wanted.size();
    if (&tree != &state.nothing || (wanted != 0 && wanted != ids.size())) {
      return search(tree, ids, options);
    }
    PairOptions of_none = options;
    of_none.wanted = {};
    return search(tree, Span<const std::uint32_t>(), of_none);
  });
}

// Calls visit(ids) for up to 512 bodies at a time, until it returns false.
template <typename Visit>
void ForEachWithLate(const BroadPhaseState& state, const Reading& reading,
                     const BvhQueries& query, const QueryOptions& options,
                     const Visit& visit) {
  bool goes_on = true;
  const auto call = [&](Span<const std::uint32_t> ids) {
    goes_on = visit(ids);
    return goes_on;
  };
  const auto call_timely = [&](Span<const std::uint32_t> ids) {
    std::uint32_t timely[512];
    std::size_t count = 0;
    for (const std::uint32_t id : ids) {
      timely[count] = id;
      count += reading.IsLate(id) ? 0 : 1;
    }
    return count == 0 || call({timely, count});
  };
  const auto run = [&](const BvhTree& tree, const auto& function) {
    using Function = std::remove_reference_t<decltype(function)>;
    BvhForEach(
        tree, query,
        [](void* context, Span<const std::uint32_t> ids) {
          return (*static_cast<Function*>(context))(ids);
        },
        const_cast<void*>(static_cast<const void*>(&function)), options);
    return goes_on;
  };
  LateLeaf leaf(state);
  if (leaf.ForEach(reading,
                   [&](const BvhTree& late) { return run(late, call); })) {
    run(state.tree, call_timely);
  }
}

// A cast through several trees, one after another: the limit of one is that of
// the next.
struct CastOfTrees {
  NearFunction function;
  void* context;
  const Reading& reading;
  LineCast cast;
  bool skips_late = false;

  // Returns whether to go on.
  bool Run(const BvhTree& tree, const SearchOptions& options) {
    BvhCast(
        tree, cast,
        [](void* casts, std::uint32_t id, float t, const float* planes) {
          auto& self = *static_cast<CastOfTrees*>(casts);
          if (!self.skips_late || !self.reading.IsLate(id)) {
            const float limit = self.function(self.context, id, t, planes);
            if (limit < self.cast.max_t) self.cast.max_t = limit;
          }
          return self.cast.max_t;
        },
        this, options);
    return !(cast.max_t < 0);
  }
};

}  // namespace

std::size_t BroadPhaseCore::Survivors(const BvhQueries& query,
                                      Span<std::uint32_t> ids,
                                      const QueryOptions& options,
                                      std::size_t skip) const {
  return Ask(
      *state_,
      [&](const BvhTree& tree) {
        return BvhSurvivors(tree, query, ids, options, skip);
      },
      [&](const Reading& reading) {
        std::ignore = BvhSurvivors(state_->nothing, query, ids, options, skip);
        IdSink to(ids, skip);
        ForEachWithLate(*state_, reading, query, options,
                        [&](Span<const std::uint32_t> some) {
                          for (const std::uint32_t id : some) {
                            *to.next++ = id;
                            if (to.next >= to.full) to.Flush();
                          }
                          return true;
                        });
        to.Flush();
        return to.flushed;
      });
}

std::size_t BroadPhaseCore::Count(const BvhQueries& query,
                                  const QueryOptions& options) const {
  return Ask(
      *state_,
      [&](const BvhTree& tree) { return BvhCount(tree, query, options); },
      [&](const Reading& reading) {
        std::size_t count = 0;
        ForEachWithLate(*state_, reading, query, options,
                        [&](Span<const std::uint32_t> ids) {
                          count += ids.size();
                          return true;
                        });
        return count;
      });
}

bool BroadPhaseCore::Any(const BvhQueries& query, std::uint32_t& id,
                         const QueryOptions& options) const {
  return Ask(
      *state_,
      [&](const BvhTree& tree) { return BvhAny(tree, query, id, options); },
      [&](const Reading& reading) {
        bool is_any = false;
        ForEachWithLate(*state_, reading, query, options,
                        [&](Span<const std::uint32_t> ids) {
                          id = ids[0];
                          is_any = true;
                          return false;
                        });
        return is_any;
      });
}

void BroadPhaseCore::ForEach(const BvhQueries& query, IdsFunction function,
                             void* context, const QueryOptions& options) const {
  Ask(
      *state_,
      [&](const BvhTree& tree) {
        BvhForEach(tree, query, function, context, options);
      },
      [&](const Reading& reading) {
        ForEachWithLate(*state_, reading, query, options,
                        [&](Span<const std::uint32_t> ids) {
                          return function(context, ids);
                        });
      });
}

std::size_t BroadPhaseCore::SurvivorsOfEach(const BvhQueries& queries,
                                            Span<std::uint32_t> ids,
                                            Span<std::size_t> offsets,
                                            const QueryOptions& options,
                                            std::size_t skip) const {
  return AskCopy(*state_, [&](const BvhTree& tree) {
    return BvhSurvivorsOfEach(tree, queries, ids, offsets, options, skip);
  });
}

std::size_t BroadPhaseCore::Nearest(const NearQueries& query,
                                    float max_distance, Span<std::uint32_t> ids,
                                    Span<float> distances,
                                    const SearchOptions& options) const {
  return AskCopy(*state_, [&](const BvhTree& tree) {
    return BvhNearest(tree, query, max_distance, ids, distances, options);
  });
}

void BroadPhaseCore::Cast(const LineCast& cast, NearFunction function,
                          void* context, const SearchOptions& options) const {
  Ask(
      *state_,
      [&](const BvhTree& tree) {
        BvhCast(tree, cast, function, context, options);
      },
      [&](const Reading& reading) {
        CastOfTrees casts{function, context, reading, cast};
        LateLeaf leaf(*state_);
        if (!leaf.ForEach(reading, [&](const BvhTree& late) {
              return casts.Run(late, options);
            })) {
          return;
        }
        casts.skips_late = true;
        casts.Run(state_->tree, options);
      });
}

std::size_t BroadPhaseCore::PairsOf(const BvhPairKernels* kernels,
                                    Span<const std::uint32_t> ids,
                                    Span<IdPair> pairs,
                                    const PairOptions& options) const {
  return AskPairs(
      *state_, "PairsOf", ids, options,
      [&](const BvhTree& tree, const Span<const std::uint32_t>& set,
          const PairOptions& its) {
        return BvhPairs({kernels, &tree, nullptr, &set}, pairs, its);
      });
}

void BroadPhaseCore::ForEachPairOf(const BvhPairKernels* kernels,
                                   Span<const std::uint32_t> ids,
                                   PairsFunction function, void* context,
                                   const PairOptions& options) const {
  AskPairs(
      *state_, "ForEachPairOf", ids, options,
      [&](const BvhTree& tree, const Span<const std::uint32_t>& set,
          const PairOptions& its) {
        BvhForEachPair({kernels, &tree, nullptr, &set}, function, context, its);
      });
}

std::size_t BroadPhaseCore::size() const {
  return state_->size.load(std::memory_order_relaxed);
}

std::size_t BroadPhaseCore::id_limit() const {
  const Reading reading(*state_);
  return state_->tree.id_limit();
}

bool BroadPhaseCore::Has(std::uint32_t id) const {
  return state_->records.Has(id);
}

void BroadPhaseCore::Get(std::uint32_t id, Span<float> values) const {
  constexpr const char* kCall = "BroadPhase::Get";
  while (!state_->records.Read(id, values.data())) {
    state_->CheckBodies(kCall, {&id, 1});
  }
}

BodyMasks BroadPhaseCore::MasksOf(std::uint32_t id) const {
  for (;;) {
    {
      const Reading reading(*state_);
      if (Has(id)) return state_->MasksOf(id);
    }
    state_->CheckBodies("BroadPhase::MasksOf", {&id, 1});
  }
}

void BroadPhaseCore::Bounds(Span<float> values) const {
  AskCopy(*state_, [&](const BvhTree& tree) { tree.Bounds(values); });
}

bool BroadPhaseCore::Validate() const {
  const Changing changing("BroadPhase::Validate", *state_);
  state_->Flush();
  const BvhTree& tree = state_->tree;
  for (const std::uint32_t id : tree.ids()) {
    float of_tree[kMostBodyPlanes];
    float of_body[kMostBodyPlanes];
    // Altered bytes of Load() may have any id in an empty slot.
    if (!tree.Has(id)) continue;
    tree.Get(id, Span<float>(of_tree, state_->planes()));
    if (!state_->records.Read(id, of_body) ||
        std::memcmp(of_tree, of_body, state_->planes() * sizeof(float)) != 0) {
      return false;
    }
  }
  return tree.size() == size();
}

BroadPhaseStatistics BroadPhaseCore::Statistics() const {
  const Changing changing("BroadPhase::Statistics", *state_);
  BroadPhaseStatistics statistics;
  statistics.bodies = size();
  statistics.pairs = state_->events.pairs().size();
  statistics.bytes = sizeof(BroadPhaseState) + state_->records.bytes() +
                     state_->tree.bytes() + state_->events.bytes() +
                     state_->changed_slots.capacity() * sizeof(std::uint64_t) +
                     state_->collides_with.capacity() * sizeof(std::uint32_t);
  statistics.cost_ratio = state_->tree.CostRatio();
  return statistics;
}

}  // namespace halfspace::detail
