// Pairs of a broad phase. Pairs of the tree's bounds are candidates, which are
// tested again by the bodies' own bounds.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "kernels/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

using Keys = List<std::uint64_t>;

// By one byte after another, without those in which all keys are equal. With
// std::sort, UpdatePairs() takes 1.4 times as long (16 000 boxes that move).
[[gnu::noinline]] void Sort(const MemoryResource& memory, Keys& keys) {
  Keys sorted(memory);
  sorted.Resize(keys.size(), 0);
  for (int shift = 0; shift < 64; shift += 8) {
    const auto digit = [shift](std::uint64_t key) {
      return static_cast<std::uint8_t>(key >> shift);
    };
    std::array<std::size_t, 256> places{};
    for (const std::uint64_t key : keys) ++places[digit(key)];
    if (keys.size() == 0 || places[digit(keys[0])] == keys.size()) continue;
    std::size_t begin = 0;
    for (std::size_t& place : places) {
      const std::size_t count = place;
      place = begin;
      begin += count;
    }
    for (const std::uint64_t key : keys) sorted[places[digit(key)]++] = key;
    keys.Swap(sorted);
  }
}

class PairFinder {
 public:
  PairFinder(const BroadPhaseState& state, const Version& version, float margin,
             BodyPairFunction function, void* context)
      : state_(state),
        version_(version),
        margin_(margin),
        function_(function),
        context_(context) {}

  void Find(const BvhPairKernels* kernels, Span<const std::uint32_t> ids) {
    const BroadPhaseState& state = state_;
    List<std::uint32_t> in_tree(state.options.memory);
    in_tree.Reserve(ids.size());
    for (const std::uint32_t id : ids) {
      if (version_.tree.Has(id)) {
        in_tree.Push(id);
      } else {
        AddNew(id);
      }
    }
    if (in_tree.size() > 0 && !JoinTree(kernels, in_tree)) return;
    const std::size_t pending = version_.PendingCount();
    if (pending == 0) return;
    for (std::size_t i = 0; i < new_count_; ++i) {
      if (!JoinNew(new_[i], pending)) return;
    }
    Keys others(state.options.memory);
    others.Reserve(in_tree.size());
    for (const std::uint32_t id : in_tree) others.Push(id);
    Sort(state.options.memory, others);
    for (std::size_t i = 0; i < pending; ++i) {
      const std::uint32_t id = version_.Pending(i);
      if (IsNewOfSet(id)) continue;
      for (std::size_t o = 0; o < others.size(); ++o) {
        if (o > 0 && others[o] == others[o - 1]) continue;
        if (!Test(static_cast<std::uint32_t>(others[o]), id)) return;
      }
    }
  }

 private:
  // Ids are in the list once, so there are no more than it has, without those
  // that the caller gave twice.
  void AddNew(std::uint32_t id) {
    if (!IsNewOfSet(id) && new_count_ < Version::kMostPending) {
      new_[new_count_++] = id;
    }
  }
  [[gnu::noinline]] bool IsNewOfSet(std::uint32_t id) const {
    return std::find(new_, new_ + new_count_, id) != new_ + new_count_;
  }

  // The pairs in the tree.
  [[gnu::noinline]] bool JoinTree(const BvhPairKernels* kernels,
                                  Span<const std::uint32_t> ids) {
    PairOptions options;
    options.margin = margin_;
    bool goes_on = true;
    const auto call = [&](Span<const IdPair> pairs) {
      for (const IdPair& pair : pairs) {
        state_.bodies.Prefetch(pair.a);
        state_.bodies.Prefetch(pair.b);
      }
      for (const IdPair& pair : pairs) {
        goes_on = Test(pair.a, pair.b);
        if (!goes_on) break;
      }
      return goes_on;
    };
    using Call = decltype(call);
    BvhForEachPair(
        {kernels, &version_.tree, nullptr, &ids},
        [](void* context, Span<const IdPair> pairs) {
          return (*static_cast<const Call*>(context))(pairs);
        },
        const_cast<void*>(static_cast<const void*>(&call)), options);
    return goes_on;
  }

  // The pairs of a new body of the set.
  [[gnu::noinline]] bool JoinNew(std::uint32_t id, std::size_t pending) {
    for (std::size_t i = 0; i < pending; ++i) {
      const std::uint32_t other = version_.Pending(i);
      if (other == id || (other < id && IsNewOfSet(other))) continue;
      if (!Test(id, other)) return false;
    }
    Body body;
    if (!state_.bodies.Read(id, body)) return true;
    kernels::InDefaultFpMode([&] { Grow(body.planes); });
    bool goes_on = true;
    const auto call = [&](Span<const std::uint32_t> others) {
      for (const std::uint32_t other : others) {
        goes_on = Test(id, other);
        if (!goes_on) break;
      }
      return goes_on;
    };
    using Call = decltype(call);
    BvhForEach(
        version_.tree, {body.planes, 1},
        [](void* context, Span<const std::uint32_t> others) {
          return (*static_cast<const Call*>(context))(others);
        },
        const_cast<void*>(static_cast<const void*>(&call)), QueryOptions());
    return goes_on;
  }

  double MarginOf(std::size_t axis) const {
    const bool is_d = axis >= state_.shape.dims;
    return (is_d ? state_.shape.dims : 1) * double{margin_};
  }

  // By the margin, rounded outward.
  void Grow(float* planes) const {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    if (margin_ == 0) return;
    for (std::size_t p = 0; p < state_.planes(); ++p) {
      const double margin = MarginOf(p % state_.shape.axes);
      const bool is_max = p >= state_.shape.axes;
      const auto grown =
          static_cast<float>(is_max ? planes[p] + margin : planes[p] - margin);
      planes[p] = std::nextafter(grown, is_max ? kInf : -kInf);
    }
  }

  // Whether min - max > margin, without rounding: the tree has another rounding
  // than bodies that are not in it yet. With a NaN, as with infinities that are
  // equal, it is not greater.
  static bool AreApart(double min, double max, double margin) {
    const double distance = min - max;
    if (distance != margin) return distance > margin;
    const double of_max = min - distance;
    return (min - (distance + of_max)) + (of_max - max) > 0;
  }

  bool Overlap(const Body& a, const Body& b) const {
    const std::size_t axes = state_.shape.axes;
    for (std::size_t k = 0; k < axes; ++k) {
      const double margin = MarginOf(k);
      if (AreApart(a.planes[k], b.planes[axes + k], margin)) return false;
      if (AreApart(b.planes[k], a.planes[axes + k], margin)) return false;
    }
    return true;
  }

  // Calls the function if the two are a pair. Returns whether to go on.
  [[gnu::noinline]] bool Test(std::uint32_t a, std::uint32_t b) {
    Body of_a;
    Body of_b;
    if (!state_.bodies.Read(a, of_a) || !state_.bodies.Read(b, of_b)) {
      return true;
    }
    const bool masks_match =
        (of_a.masks.category & of_b.masks.collides_with) != 0 &&
        (of_b.masks.category & of_a.masks.collides_with) != 0;
    const PairFilter& filter = state_.options.filter;
    if (!masks_match && filter.keep == nullptr) return true;
    if (!kernels::InDefaultFpMode([&] { return Overlap(of_a, of_b); })) {
      return true;
    }
    const WithoutRacyReads reads;
    if (filter.keep != nullptr &&
        !filter.keep(filter.context, a, b, masks_match)) {
      return true;
    }
    return function_(context_, a, b);
  }

  const BroadPhaseState& state_;
  const Version& version_;
  float margin_;
  BodyPairFunction function_;
  void* context_;
  std::size_t new_count_ = 0;
  std::uint32_t new_[Version::kMostPending];  // those of the set
};

std::uint64_t KeyOf(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}
std::uint32_t LowOf(std::uint64_t key) {
  return static_cast<std::uint32_t>(key >> 32);
}
std::uint32_t HighOf(std::uint64_t key) {
  return static_cast<std::uint32_t>(key);
}

}  // namespace

void BroadPhaseCore::ForEachPairOf(const BvhPairKernels* kernels,
                                   Span<const std::uint32_t> ids, float margin,
                                   BodyPairFunction function,
                                   void* context) const {
  constexpr const char* kCall = "BroadPhase::ForEachPairOf";
  state_->CheckBodies(kCall, ids);
  CheckMargin(kCall, "margin", margin);
  const Held version(*state_);
  const WithRacyReads reads;
  PairFinder(*state_, *version, margin, function, context).Find(kernels, ids);
}

void BroadPhaseCore::UpdatePairs(const BvhPairKernels* kernels,
                                 const PairEvents& events) {
  BroadPhaseState& state = *state_;
  const MemoryResource& memory = state.options.memory;
  Keys began(memory);
  Keys ended(memory);
  {
    const std::scoped_lock lock(state.mutex);
    TakenMarks changed(state, Bodies::kNewPairs);
    changed.Take();
    const Held version(state);
    List<std::uint32_t> ids(memory);
    Keys is_changed(memory);
    ids.Reserve(changed.ids().size());
    is_changed.Resize((state.id_limit + 63) / 64, 0);
    for (const std::uint32_t id : changed.ids()) {
      is_changed[id / 64] |= std::uint64_t{1} << id % 64;
      Body body;
      if (!state.bodies.Read(id, body)) continue;
      // A mover whose mark was taken may not have done this yet.
      version->Widen(id, body.planes, false);
      ids.Push(id);
    }

    Keys found(memory);
    {
      const WithRacyReads reads;
      PairFinder(
          state, *version, 0,
          [](void* keys, std::uint32_t a, std::uint32_t b) {
            static_cast<Keys*>(keys)->Push(KeyOf(a, b));
            return true;
          },
          &found)
          .Find(kernels, ids);
    }
    Sort(memory, found);

    const auto has_changed = [&](std::uint64_t key) {
      const auto has = [&](std::uint32_t id) {
        return (is_changed[id / 64] >> id % 64 & 1) != 0;
      };
      return has(LowOf(key)) || has(HighOf(key));
    };
    Keys now(memory);
    now.Reserve(state.pairs.size() + found.size());
    const std::uint64_t* next = found.begin();
    const auto begin_before = [&](std::uint64_t key) {
      for (; next != found.end() && *next < key; ++next) {
        began.Push(*next);
        now.Push(*next);
      }
    };
    for (const std::uint64_t key : state.pairs) {
      begin_before(key);
      const bool is_found = next != found.end() && *next == key;
      if (is_found) ++next;
      if (is_found || !has_changed(key)) {
        now.Push(key);
      } else {
        ended.Push(key);
      }
    }
    begin_before(~std::uint64_t{0});
    state.pairs.Swap(now);
    changed.Keep();
  }
  for (const std::uint64_t key : ended) {
    events.ended(events.context, LowOf(key), HighOf(key));
  }
  for (const std::uint64_t key : began) {
    events.began(events.context, LowOf(key), HighOf(key));
  }
}

}  // namespace halfspace::detail
