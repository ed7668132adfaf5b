// Pairs of a broad phase. Pairs of the tree's bounds are candidates, which are
// tested again by the bodies' own bounds.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "kernels/exact/default_fp_mode.h"

namespace halfspace::detail {
namespace {

// A candidate: the lesser id, then the greater one, then whether they are a
// pair.
using Keys = List<std::uint64_t>;
std::uint64_t KeyOf(std::uint32_t a, std::uint32_t b, bool is_pair) {
  return std::uint64_t{std::min(a, b)} << 33 |
         std::uint64_t{std::max(a, b)} << 1 | (is_pair ? 1 : 0);
}
std::uint32_t LowOf(std::uint64_t key) {
  return static_cast<std::uint32_t>(key >> 33);
}
std::uint32_t HighOf(std::uint64_t key) {
  return static_cast<std::uint32_t>(key) >> 1;
}
bool IsPair(std::uint64_t key) { return (key & 1) != 0; }

// By one byte after another, without those in which all keys are equal. With
// std::sort, UpdatePairs() takes 1.4 times as long (16 000 boxes that move).
[[gnu::noinline]] void Sort(const MemoryResource& memory, Keys& keys) {
  constexpr std::size_t kFew = 256;
  if (keys.size() < kFew) return std::sort(keys.begin(), keys.end());
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

bool MasksMatch(const Body& a, const Body& b) {
  return (a.masks.category & b.masks.collides_with) != 0 &&
         (b.masks.category & a.masks.collides_with) != 0;
}

// Finds the candidates of changed bodies, and puts them among all others.
template <std::size_t kAxes>
class PairUpdate {
 public:
  PairUpdate(BroadPhaseState& state, const Version& version,
             const IdSet& changed, const IdSet& touched, Keys& began,
             Keys& ended)
      : state_(state),
        version_(version),
        changed_(changed),
        touched_(touched),
        began_(began),
        ended_(ended),
        found_(state.options.memory) {}

  void Run(const BvhPairKernels* kernels) {
    const WithRacyReads reads;
    const std::size_t changed = changed_.size();
    if (changed > 0) {
      Find(kernels, changed);
      Sort(state_.options.memory, found_);
    }
    Keys now(state_.options.memory);
    now.Reserve(state_.candidates.size() + found_.size());
    kernels::CallApart([&] { Merge(now); });
    state_.candidates.Swap(now);
    state_.pairs += began_.size();
    state_.pairs -= ended_.size();
  }

 private:
  // With more, all pairs of the tree take less time.
  static constexpr std::size_t kShareOfSet = 4;

  // With a NaN, as with infinities that are equal, they do.
  static bool Overlap(const Body& a, const Body& b) {
    bool is_apart = false;
    for (std::size_t k = 0; k < kAxes; ++k) {
      is_apart |= a.planes[k] > b.planes[kAxes + k];
      is_apart |= b.planes[k] > a.planes[kAxes + k];
    }
    return !is_apart;
  }
  // In the mode of the caller.
  bool AsksToKeep(std::uint32_t a, std::uint32_t b, bool masks_match) {
    const PairFilter& filter = state_.options.filter;
    return mode_.Outside([&] {
      const WithoutRacyReads reads;
      return filter.keep(filter.context, a, b, masks_match);
    });
  }

  [[gnu::noinline]] void Find(const BvhPairKernels* kernels,
                              std::size_t changed) {
    const bool is_of_set = kShareOfSet * changed < version_.tree.size();
    List<std::uint32_t> ids(state_.options.memory);
    if (is_of_set) {
      ids.Reserve(changed);
      changed_.ForEach([&](std::uint32_t id) {
        if (version_.Find(id) != nullptr) ids.Push(id);
      });
    }
    const Span<const std::uint32_t> set = ids;
    if (!is_of_set || ids.size() > 0) {
      BvhForEachPair(
          {kernels, &version_.tree, nullptr, is_of_set ? &set : nullptr},
          [](void* self, Span<const IdPair> pairs) {
            static_cast<PairUpdate*>(self)->Add(pairs);
            return true;
          },
          this, PairOptions());
    }
    for (std::size_t i = 0; i < version_.PendingCount(); ++i) AddPending(i);
  }

  [[gnu::noinline]] void Add(Span<const IdPair> pairs) {
    for (const IdPair& pair : pairs) {
      state_.bodies.Prefetch(pair.a);
      state_.bodies.Prefetch(pair.b);
    }
    for (const IdPair& pair : pairs) Add(pair.a, pair.b);
  }
  // Two bodies whose bounds in the tree overlap. A body that is in no tree has
  // its own bound instead.
  void Add(std::uint32_t a, std::uint32_t b) {
    if (!changed_.Has(a) && !changed_.Has(b)) return;
    Body of_a;
    Body of_b;
    if (!state_.bodies.ReadAs<kAxes, true>(a, of_a) ||
        !state_.bodies.ReadAs<kAxes, true>(b, of_b)) {
      return;
    }
    const bool masks_match = MasksMatch(of_a, of_b);
    const bool is_kept = state_.options.filter.keep != nullptr
                             ? AsksToKeep(a, b, masks_match)
                             : masks_match;
    if (is_kept) found_.Push(KeyOf(a, b, Overlap(of_a, of_b)));
  }

  [[gnu::noinline]] void AddPending(std::size_t i) {
    const std::uint32_t id = version_.Pending(i);
    for (std::size_t j = 0; j < i; ++j) Add(version_.Pending(j), id);
    Body body;
    if (!state_.bodies.Read(id, body)) return;
    struct Call {
      PairUpdate& self;
      std::uint32_t id;
    } call{*this, id};
    BvhForEach(
        version_.tree, {body.planes, 1},
        [](void* context, Span<const std::uint32_t> others) {
          const Call& of = *static_cast<const Call*>(context);
          for (const std::uint32_t other : others) of.self.Add(of.id, other);
          return true;
        },
        &call, QueryOptions());
  }

  // Puts what was found among the other candidates of bodies that did not
  // change, and tests those of bodies that moved inside their bounds.
  void Merge(Keys& now) {
    const std::uint64_t* next = found_.begin();
    const std::uint64_t* const found_end = found_.end();
    std::uint64_t* to = now.data();
    const bool has_changed = found_end != next || changed_.size() > 0;
    const auto begin_before = [&](std::uint64_t key) {
      for (; next != found_end && *next < key; ++next) {
        if (IsPair(*next)) began_.Push(*next);
        *to++ = *next;
      }
    };
    for (const std::uint64_t old : state_.candidates) {
      const std::uint32_t a = LowOf(old);
      const std::uint32_t b = HighOf(old);
      std::uint64_t is = old;
      if (has_changed && (changed_.Has(a) || changed_.Has(b))) {
        const std::uint64_t key = old & ~std::uint64_t{1};
        begin_before(key);
        if (next == found_end || *next - key >= 2) {
          if (IsPair(old)) ended_.Push(old);
          continue;
        }
        is = *next++;
      } else {
        begin_before(old);
        if (touched_.Has(a) || touched_.Has(b)) is = TestAgain(a, b);
      }
      if (is != old) (IsPair(is) ? began_ : ended_).Push(is);
      *to++ = is;
    }
    begin_before(~std::uint64_t{0});
    now.SetSize(static_cast<std::size_t>(to - now.data()));
  }

  // A candidate, which the masks and the filter keep.
  std::uint64_t TestAgain(std::uint32_t a, std::uint32_t b) {
    // Keys ascend, so the next ones often have the same first body.
    if (a != low_) {
      low_ = a;
      has_low_ = state_.bodies.ReadAs<kAxes, false>(a, of_low_);
    }
    Body of_b;
    const bool is_pair = has_low_ &&
                         state_.bodies.ReadAs<kAxes, false>(b, of_b) &&
                         Overlap(of_low_, of_b);
    return KeyOf(a, b, is_pair);
  }

  BroadPhaseState& state_;
  const Version& version_;
  const IdSet& changed_;
  const IdSet& touched_;
  Keys& began_;
  Keys& ended_;
  Keys found_;
  std::uint32_t low_ = ~std::uint32_t{0};
  bool has_low_ = false;
  Body of_low_;
  kernels::DefaultFpMode mode_;
};

// The masks of a call for the bodies of its set.
class CallMasks {
 public:
  CallMasks(const MemoryResource& memory, Span<const std::uint32_t> ids,
            Span<const std::uint64_t> masks)
      : masks_(memory) {
    masks_.Reserve(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
      masks_.Push({ids[i], masks[i]});
    }
    std::sort(masks_.begin(), masks_.end(), IsBefore);
  }

  // Whether a body of the set wants another one.
  bool Wants(std::uint32_t id, const BodyMasks& other) const {
    const Of* of =
        std::lower_bound(masks_.begin(), masks_.end(), Of{id, 0}, IsBefore);
    for (; of != masks_.end() && of->id == id; ++of) {
      if (HasMask(other, of->mask)) return true;
    }
    return false;
  }

 private:
  struct Of {
    std::uint32_t id;
    std::uint64_t mask;
  };
  static bool IsBefore(const Of& a, const Of& b) { return a.id < b.id; }
  List<Of> masks_;
};

class PairFinder {
 public:
  // `masks` is null without masks of the call.
  PairFinder(const BroadPhaseState& state, const Version& version,
             const CallMasks* masks, float margin, BodyPairFunction function,
             void* context)
      : state_(state),
        version_(version),
        masks_(masks),
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
    List<std::uint32_t> others(state.options.memory);
    others.Reserve(in_tree.size());
    for (const std::uint32_t id : in_tree) others.Push(id);
    std::sort(others.begin(), others.end());
    for (std::size_t i = 0; i < pending; ++i) {
      const std::uint32_t id = version_.Pending(i);
      if (IsNewOfSet(id)) continue;
      for (std::size_t o = 0; o < others.size(); ++o) {
        if (o > 0 && others[o] == others[o - 1]) continue;
        if (!Test(others[o], id)) return;
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
        masks_ == nullptr
            ? MasksMatch(of_a, of_b)
            : masks_->Wants(a, of_b.masks) || masks_->Wants(b, of_a.masks);
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
  const CallMasks* masks_;
  float margin_;
  BodyPairFunction function_;
  void* context_;
  std::size_t new_count_ = 0;
  std::uint32_t new_[Version::kMostPending];  // those of the set
};

}  // namespace

void BroadPhaseCore::ForEachPairOf(const BvhPairKernels* kernels,
                                   Span<const std::uint32_t> ids,
                                   const Span<const std::uint64_t>* masks,
                                   float margin, BodyPairFunction function,
                                   void* context) const {
  constexpr const char* kCall = "BroadPhase::ForEachPairOf";
  if (masks != nullptr) {
    state_->CheckList(kCall, ids, "masks", masks->data(), masks->size(),
                      alignof(std::uint64_t));
  }
  state_->CheckBodies(kCall, ids);
  CheckMargin(kCall, "margin", margin);
  const bool has_masks = masks != nullptr;
  const CallMasks of_call(state_->options.memory,
                          has_masks ? ids : Span<const std::uint32_t>(),
                          has_masks ? *masks : Span<const std::uint64_t>());
  const Held version(*state_);
  const WithRacyReads reads;
  PairFinder(*state_, *version, has_masks ? &of_call : nullptr, margin,
             function, context)
      .Find(kernels, ids);
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
    TakenMarks touched(state, Bodies::kTouched);
    changed.Take();
    touched.Take();
    const Held version(state);
    WithAxes(state.shape.axes, [&](auto axes) {
      PairUpdate<decltype(axes)::value>(state, *version, changed, touched,
                                        began, ended)
          .Run(kernels);
    });
    changed.Keep();
    touched.Keep();
  }
  for (const std::uint64_t key : ended) {
    events.ended(events.context, LowOf(key), HighOf(key));
  }
  for (const std::uint64_t key : began) {
    events.began(events.context, LowOf(key), HighOf(key));
  }
}

}  // namespace halfspace::detail
