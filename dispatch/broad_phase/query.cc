// A query of a broad phase is a query of its tree. If some bodies are late, the
// frequent kinds of queries test these bodies separately. The other kinds
// search a copy of the tree that has their bounds.
//
// A query calls a function of the caller's outside of the lock. If the tree has
// changed when the function returns, the query begins again, and leaves out the
// bodies that it has reported.
#include <algorithm>
#include <cstring>
#include <tuple>
#include <type_traits>

#include "dispatch/broad_phase/state.h"
#include "dispatch/errors/error.h"
#include "halfspace/bvh_nearest.h"
#include "halfspace/bvh_pairs.h"
#include "halfspace/visit.h"
#include "kernels/bvh/levels.h"

namespace halfspace::detail {
namespace {

// The late bodies, 64 at a time, as trees of one leaf. The kernels of the tree
// test them too, so both give the same answers.
class LateLeaf {
 public:
  explicit LateLeaf(const BroadPhaseState& state)
      : state_(state), tree_(state.type, MemoryResource()) {}
  LateLeaf(const LateLeaf&) = delete;
  LateLeaf& operator=(const LateLeaf&) = delete;

  // Calls test(tree) for each leaf of late bodies, until it returns false.
  // Returns whether it never did.
  template <typename Test>
  bool ForEach(const Reading& reading, const Test& test) {
    bool goes_on = true;
    state_.records.ForEachMarked([&](std::uint32_t id) {
      if (!reading.IsLate(id)) return true;
      Add(id);
      if (count_ == kBlockObjects) goes_on = Run(test);
      return goes_on;
    });
    return goes_on && (count_ == 0 || Run(test));
  }

 private:
  void Add(std::uint32_t id) {
    const BvhLevels& all = state_.tree.levels();
    WithAxes(state_.type.axes, [&](auto axes) {
      state_.records.Copy<axes>(id, floats_ + count_);
    });
    ids_[count_] = id;
    const std::uint32_t* const masks = all.level[0].masks;
    masks_[count_] = masks == nullptr ? 0xFFFFFFFF : masks[all.slots[id]];
    ++count_;
  }

  template <typename Test>
  bool Run(const Test& test) {
    BvhLevels levels;
    levels.count = 1;
    levels.ids = ids_;
    levels.level[0].size = count_;
    levels.level[0].floats = floats_;
    levels.level[0].planes = state_.planes();
    levels.level[0].present = &present_;
    if (state_.tree.levels().level[0].masks != nullptr) {
      levels.level[0].masks = masks_;
    }
    present_ = ~std::uint64_t{0} >> (kBlockObjects - count_);
    count_ = 0;
    BvhState::Of(tree_).Borrow(levels);
    return test(tree_);
  }

  const BroadPhaseState& state_;
  BvhTree tree_;
  std::size_t count_ = 0;
  std::uint64_t present_ = 0;
  std::uint32_t ids_[kBlockObjects] = {};
  std::uint32_t masks_[kBlockObjects];
  alignas(64) float floats_[kMostBodyPlanes * kBlockObjects] = {};
};

// The bodies that a query has reported, and whether it has to begin again.
class Reported {
 public:
  explicit Reported(const BroadPhaseState& state)
      : memory_(state.options.memory),
        ids_(BlockAllocator<std::uint32_t>(memory_.resource())) {
    ids_.reserve(kFew);
  }

  // Calls run(reading) until no change has interrupted it.
  template <typename Run>
  void RunAll(BroadPhaseState& state, const Run& run) {
    do {
      is_interrupted_ = false;
      before_ = ids_.size();
      std::sort(ids_.begin(), ids_.end());
      Reading reading(state);
      run(reading);
    } while (is_interrupted_);
  }
  // Whether an earlier run has reported it.
  bool Has(std::uint32_t id) const {
    const auto end = ids_.begin() + static_cast<std::ptrdiff_t>(before_);
    return before_ != 0 && std::binary_search(ids_.begin(), end, id);
  }
  // Those that it has not, in place or in `room`.
  Span<const std::uint32_t> Others(Span<const std::uint32_t> ids,
                                   std::uint32_t* room) const {
    if (before_ == 0) return ids;
    std::size_t count = 0;
    for (const std::uint32_t id : ids) {
      room[count] = id;
      count += Has(id) ? 0 : 1;
    }
    return {room, count};
  }
  // Reports some bodies by function(), which returns whether to go on. Returns
  // whether the run goes on.
  template <typename Function>
  bool Report(Reading& reading, Span<const std::uint32_t> ids,
              const Function& function) {
    ids_.insert(ids_.end(), ids.begin(), ids.end());
    bool goes_on = false;
    const bool is_same = reading.CallOutside([&] { goes_on = function(); });
    is_interrupted_ = goes_on && !is_same;
    return goes_on && is_same;
  }

 private:
  // The bodies that most casts report.
  static constexpr std::size_t kFew = 64;

  CallMemory memory_;
  BlockVector<std::uint32_t> ids_;
  std::size_t before_ = 0;
  bool is_interrupted_ = false;
};

// Calls exact(tree) if the tree has all bounds, and else late(reading).
template <typename Exact, typename Late>
auto Ask(BroadPhaseState& state, const Exact& exact, const Late& late) {
  const Reading reading(state);
  return reading.is_exact() ? exact(reading.tree()) : late(reading);
}

// Calls exact(tree), with a copy of the tree if some bodies are late.
template <typename Exact>
auto AskCopy(BroadPhaseState& state, const Exact& exact) {
  return Ask(state, exact, [&](const Reading& reading) {
    BvhTree copy(reading.tree(), state.options.memory);
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
    Callback callback{function};
    tree.ForEach(query, &decltype(callback)::Run, &callback, options);
    return goes_on;
  };
  LateLeaf leaf(state);
  if (leaf.ForEach(reading,
                   [&](const BvhTree& late) { return run(late, call); })) {
    run(reading.tree(), call_timely);
  }
}

}  // namespace

std::size_t BroadPhaseCore::Survivors(const BvhQueries& query,
                                      Span<std::uint32_t> ids,
                                      const QueryOptions& options,
                                      std::size_t skip) const {
  return Ask(
      *state_,
      [&](const BvhTree& tree) {
        return tree.Survivors(query, ids, options, skip);
      },
      [&](const Reading& reading) {
        // Checks the arguments in the name of this call.
        const BvhTree nothing(state_->type, state_->options.memory);
        std::ignore = nothing.Survivors(query, ids, options, skip);
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
      *state_, [&](const BvhTree& tree) { return tree.Count(query, options); },
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
      [&](const BvhTree& tree) { return tree.Any(query, id, options); },
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
  // Most queries find a few bodies, and call the function once, at their end.
  std::uint32_t few[512];
  const std::size_t count = Survivors(query, few, options, 0);
  if (count <= std::size(few)) {
    if (count > 0) function(context, {few, count});
    return;
  }
  Reported reported(*state_);
  reported.RunAll(*state_, [&](Reading& reading) {
    const auto visit = [&](Span<const std::uint32_t> ids) {
      std::uint32_t others[512];
      const Span<const std::uint32_t> some = reported.Others(ids, others);
      return some.empty() || reported.Report(reading, some, [&] {
        return function(context, some);
      });
    };
    if (!reading.is_exact()) {
      return ForEachWithLate(*state_, reading, query, options, visit);
    }
    Callback callback{visit};
    reading.tree().ForEach(query, &decltype(callback)::Run, &callback, options);
  });
}

std::size_t BroadPhaseCore::SurvivorsOfEach(const BvhQueries& queries,
                                            Span<std::uint32_t> ids,
                                            Span<std::size_t> offsets,
                                            const QueryOptions& options,
                                            std::size_t skip) const {
  return AskCopy(*state_, [&](const BvhTree& tree) {
    return tree.SurvivorsOfEach(queries, ids, offsets, options, skip);
  });
}

std::size_t BroadPhaseCore::Nearest(const NearQueries& query,
                                    float max_distance, Span<std::uint32_t> ids,
                                    Span<float> distances,
                                    const SearchOptions& options) const {
  return AskCopy(*state_, [&](const BvhTree& tree) {
    return tree.Nearest(query, max_distance, ids, distances, options);
  });
}

void BroadPhaseCore::NearestOfEach(const NearQueries& queries, std::size_t k,
                                   float max_distance, Span<std::uint32_t> ids,
                                   Span<float> distances,
                                   const SearchOptions& options) const {
  AskCopy(*state_, [&](const BvhTree& tree) {
    tree.NearestOfEach(queries, k, max_distance, ids, distances, options);
  });
}

void BroadPhaseCore::Cast(const LineCast& cast, NearFunction function,
                          void* context, const SearchOptions& options) const {
  Reported reported(*state_);
  // The limit that one search ends with is the limit of the next one.
  LineCast rest = cast;
  reported.RunAll(*state_, [&](Reading& reading) {
    bool skips_late = false;
    bool goes_on = true;
    Callback hit{[&](std::uint32_t id, float t, const float* planes) {
      if ((skips_late && reading.IsLate(id)) || reported.Has(id)) {
        return Limit{rest.max_t};
      }
      float copy[kMostBodyPlanes * kBlockObjects];
      for (std::size_t p = 0; p < state_->planes(); ++p) {
        copy[p * kBlockObjects] = planes[p * kBlockObjects];
      }
      goes_on = reported.Report(reading, {&id, 1}, [&] {
        rest.max_t = std::min(rest.max_t, function(context, id, t, copy));
        return !(rest.max_t < 0);
      });
      return Limit{goes_on ? rest.max_t : -1};
    }};
    const auto run = [&](const BvhTree& tree) {
      tree.Cast(rest, &decltype(hit)::Run, &hit, options);
      return goes_on;
    };
    if (!reading.is_exact()) {
      LateLeaf leaf(*state_);
      if (!leaf.ForEach(reading, run)) return;
      skips_late = true;
    }
    run(reading.tree());
  });
}

std::size_t BroadPhaseCore::PairsOf(const BvhPairKernels* kernels,
                                    Span<const std::uint32_t> ids,
                                    Span<IdPair> pairs,
                                    const PairOptions& options) const {
  state_->CheckBodies("PairsOf", ids);
  return AskCopy(*state_, [&](const BvhTree& tree) {
    return tree.PairsOf(kernels, ids, pairs, options);
  });
}

void BroadPhaseCore::ForEachPairOf(const BvhPairKernels* kernels,
                                   Span<const std::uint32_t> ids,
                                   PairsFunction function, void* context,
                                   const PairOptions& options) const {
  state_->CheckBodies("ForEachPairOf", ids);
  CallMemory memory(state_->options.memory);
  BlockVector<IdPair> found(BlockAllocator<IdPair>(memory.resource()));
  Callback collect{[&](Span<const IdPair> some) {
    found.insert(found.end(), some.begin(), some.end());
  }};
  AskCopy(*state_, [&](const BvhTree& tree) {
    tree.ForEachPairOf(kernels, ids, &decltype(collect)::Run, &collect,
                       options);
  });
  constexpr std::size_t kAtOnce = 256;
  for (std::size_t i = 0; i < found.size(); i += kAtOnce) {
    const std::size_t some = std::min(kAtOnce, found.size() - i);
    if (!function(context, {found.data() + i, some})) return;
  }
}

std::size_t BroadPhaseCore::size() const {
  return state_->size.load(std::memory_order_relaxed);
}

std::size_t BroadPhaseCore::id_limit() const {
  const Reading reading(*state_);
  return reading.tree().id_limit();
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
      if (Has(id)) return state_->MasksOf(reading.tree(), id);
    }
    state_->CheckBodies("BroadPhase::MasksOf", {&id, 1});
  }
}

void BroadPhaseCore::Bounds(Span<float> values) const {
  AskCopy(*state_, [&](const BvhTree& tree) { tree.Bounds(values); });
}

bool BroadPhaseCore::Validate() const {
  const Changing changing(*state_);
  state_->Flush();
  const BvhTree& tree = state_->tree;
  for (const std::uint32_t id : tree.ids()) {
    float of_tree[kMostBodyPlanes];
    float of_body[kMostBodyPlanes];
    if (id == kNoId) continue;
    tree.Get(id, Span<float>(of_tree, state_->planes()));
    if (!state_->records.Read(id, of_body) ||
        std::memcmp(of_tree, of_body, state_->planes() * sizeof(float)) != 0) {
      return false;
    }
  }
  return tree.size() == size();
}

BroadPhaseStatistics BroadPhaseCore::Statistics() const {
  const Changing changing(*state_);
  BroadPhaseStatistics statistics;
  statistics.bodies = size();
  statistics.pairs = state_->events.pairs().size();
  statistics.bytes = sizeof(BroadPhaseState) + state_->records.bytes() +
                     state_->tree.bytes() + state_->tree_copy.bytes() +
                     state_->events.bytes() +
                     state_->changed_slots.capacity() * sizeof(std::uint64_t) +
                     state_->collides_with.capacity() * sizeof(std::uint32_t);
  statistics.cost_ratio = state_->tree.CostRatio();
  return statistics;
}

}  // namespace halfspace::detail
