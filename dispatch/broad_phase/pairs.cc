// Pairs of a broad phase. Pairs of the tree's bounds are candidates, which are
// tested again by the bodies' own bounds.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <new>

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

// The caller's resource for parts that run on several threads.
class LockedMemory {
 public:
  explicit LockedMemory(const MemoryResource& memory) : memory_(memory) {}

  MemoryResource resource() { return MemoryFrom(*this); }
  void* allocate(std::size_t bytes, std::size_t /*alignment*/) {
    const std::scoped_lock lock(mutex_);
    return AllocateBlock(memory_, bytes);
  }
  void deallocate(void* block, std::size_t bytes, std::size_t /*alignment*/) {
    const std::scoped_lock lock(mutex_);
    FreeBlock(memory_, block, bytes);
  }

 private:
  std::mutex mutex_;
  MemoryResource memory_;
};

// Two lists: those that were kept, and new ones. Both ascend.
struct Candidates {
  Span<const std::uint64_t> old;
  Span<const std::uint64_t> found;
};

// A part of an update of pairs.
class PairUpdate {
 public:
  PairUpdate(const BroadPhaseState& state, const Version& version,
             const IdSet& changed, const IdSet& touched,
             const MemoryResource& memory)
      : state_(state),
        version_(version),
        changed_(changed),
        touched_(touched),
        found_(memory),
        now_(memory),
        began_(memory),
        ended_(memory) {}

  Keys& found() { return found_; }
  Keys& now() { return now_; }
  Keys& began() { return began_; }
  Keys& ended() { return ended_; }

  // The candidates of bodies that changed, in some blocks of the tree, or of a
  // set of them.
  void Find(const BvhPairKernels* kernels, const Span<const std::uint32_t>* set,
            const PairOptions& blocks) {
    found_.Clear();
    const WithRacyReads reads;
    BvhForEachPair(
        {kernels, &version_.tree, nullptr, set},
        [](void* self, Span<const IdPair> pairs) {
          static_cast<PairUpdate*>(self)->Add(pairs);
          return true;
        },
        this, blocks);
  }
  // And of those that are in no tree.
  void FindPending() {
    const WithRacyReads reads;
    for (std::size_t i = 0; i < version_.PendingCount(); ++i) AddPending(i);
  }
  void Merge(const Candidates& candidates) {
    now_.Clear();
    began_.Clear();
    ended_.Clear();
    now_.Reserve(candidates.old.size() + candidates.found.size());
    kernels::InDefaultFpMode([&] { MergeInto(candidates, now_); });
  }

 private:
  // In the default floating-point mode: UpdatePairs() takes 1.1 times as long
  // with DoOverlap().
  static bool Overlap(const Body& a, const Body& b, std::size_t axes) {
    bool is_apart = false;
    for (std::size_t k = 0; k < axes; ++k) {
      is_apart |= a.planes[k] > b.planes[axes + k];
      is_apart |= b.planes[k] > a.planes[axes + k];
    }
    return !is_apart;
  }
  [[gnu::noinline]] void Add(Span<const IdPair> pairs) {
    for (const IdPair& pair : pairs) {
      state_.bodies.Prefetch(pair.a);
      state_.bodies.Prefetch(pair.b);
    }
    kernels::DefaultFpMode mode;
    kernels::CallApart([&] {
      for (const IdPair& pair : pairs) AddOne(pair.a, pair.b, mode);
    });
  }
  void Add(std::uint32_t a, std::uint32_t b) {
    const IdPair pair = {a, b};
    Add({&pair, 1});
  }
  // Two bodies whose bounds in the tree overlap. A body that is in no tree has
  // its own bound instead.
  void AddOne(std::uint32_t a, std::uint32_t b, kernels::DefaultFpMode& mode) {
    if (!changed_.Has(a) && !changed_.Has(b)) return;
    Body of_a;
    Body of_b;
    if (!state_.bodies.Read(a, of_a) || !state_.bodies.Read(b, of_b)) return;
    bool is_kept = MasksMatch(of_a, of_b);
    const PairFilter& filter = state_.options.filter;
    if (filter.keep != nullptr) {
      is_kept = mode.Outside([&] {
        const WithoutRacyReads reads;
        return filter.keep(filter.context, a, b, is_kept);
      });
    }
    if (is_kept)
      found_.Push(KeyOf(a, b, Overlap(of_a, of_b, state_.shape.axes)));
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

  // Records of so many candidates are prefetched together.
  static constexpr std::size_t kSome = 64;
  // The records of so many bodies stay in the cache. A prefetch gains nothing
  // there, or if few bodies were touched: few records are read then, and
  // nothing predicts which.
  static constexpr std::size_t kInCacheBodies = 8192;

  // Puts what was found among the other candidates of bodies that did not
  // change, and tests those of bodies that moved inside their bounds.
  void MergeInto(const Candidates& candidates, Keys& now) {
    const std::uint64_t* next = candidates.found.begin();
    const std::uint64_t* const found_end = candidates.found.end();
    std::uint64_t* to = now.data();
    const auto begin_before = [&](std::uint64_t key) {
      for (; next != found_end && *next < key; ++next) {
        if (IsPair(*next)) began_.Push(*next);
        *to++ = *next;
      }
    };
    const auto merge = [&](std::uint64_t old) {
      const std::uint32_t a = LowOf(old);
      const std::uint32_t b = HighOf(old);
      std::uint64_t is = old;
      if (changed_.Has(a) || changed_.Has(b)) {
        const std::uint64_t key = old & ~std::uint64_t{1};
        begin_before(key);
        if (next == found_end || *next - key >= 2) {
          if (IsPair(old)) ended_.Push(old);
          return;
        }
        is = *next++;
      } else {
        begin_before(old);
        if (touched_.Has(a) || touched_.Has(b)) is = TestAgain(a, b);
      }
      if (is != old) (IsPair(is) ? began_ : ended_).Push(is);
      *to++ = is;
    };
    const bool is_prefetched =
        4 * touched_.size() > std::max(kInCacheBodies, state_.size.load());
    const std::uint64_t* const end = candidates.old.end();
    for (const std::uint64_t* some = candidates.old.begin(); some != end;) {
      const std::uint64_t* const some_end =
          some + std::min<std::ptrdiff_t>(kSome, end - some);
      for (const std::uint64_t* k = some; is_prefetched && k != some_end; ++k) {
        state_.bodies.Prefetch(HighOf(*k));
      }
      for (; some != some_end; ++some) merge(*some);
    }
    begin_before(~std::uint64_t{0});
    now.SetSize(static_cast<std::size_t>(to - now.data()));
  }

  // A candidate, which the masks and the filter keep.
  std::uint64_t TestAgain(std::uint32_t a, std::uint32_t b) {
    // Keys ascend, so the next ones often have the same first body.
    if (a != low_) {
      low_ = a;
      has_low_ = state_.bodies.Read(a, of_low_, false);
    }
    Body of_b;
    const bool is_pair = has_low_ && state_.bodies.Read(b, of_b, false) &&
                         Overlap(of_low_, of_b, state_.shape.axes);
    return KeyOf(a, b, is_pair);
  }

  const BroadPhaseState& state_;
  const Version& version_;
  const IdSet& changed_;
  const IdSet& touched_;
  Keys found_;
  Keys now_;
  Keys began_;
  Keys ended_;
  std::uint32_t low_ = ~std::uint32_t{0};
  bool has_low_ = false;
  Body of_low_;
};

// All of an update of pairs. The parts do not depend on the threads.
class PairUpdates {
 public:
  PairUpdates(BroadPhaseState& state, const Version& version,
              const IdSet& changed, const IdSet& touched, const Runner& run)
      : state_(state),
        version_(version),
        changed_(changed),
        run_(run),
        is_of_set_(kShareOfSet * changed.size() < version.tree.size()),
        blocks_(BlocksOf(version.tree.ids().size())),
        find_parts_(is_of_set_ ? 1 : PartsFor(blocks_ / kMostBlocks)),
        merge_parts_(PartsFor(state.candidates.size() / kMostKeys)),
        memory_(state.options.memory),
        scratch_(state.options.memory,
                 std::max(find_parts_, merge_parts_) * sizeof(PairUpdate)),
        parts_(reinterpret_cast<PairUpdate*>(scratch_.data())) {
    for (; made_ < std::max(find_parts_, merge_parts_); ++made_) {
      new (parts_ + made_)
          PairUpdate(state, version, changed, touched, memory_.resource());
    }
  }
  PairUpdates(const PairUpdates&) = delete;
  PairUpdates& operator=(const PairUpdates&) = delete;
  ~PairUpdates() { std::destroy_n(parts_, made_); }

  void Run(const BvhPairKernels* kernels, Keys& began, Keys& ended) {
    Keys found(state_.options.memory);
    if (changed_.size() > 0) {
      Find(kernels);
      Append(find_parts_, &PairUpdate::found, found);
      Sort(state_.options.memory, found);
    }
    const Keys& old = state_.candidates;
    const std::size_t parts = merge_parts_;
    // Where a part begins in a list.
    const auto at = [&](const Keys& keys, std::size_t part) {
      if (part == 0) return keys.begin();
      if (part == parts) return keys.end();
      return std::lower_bound(
          keys.begin(), keys.end(),
          old[old.size() / parts * part] & ~std::uint64_t{1});
    };
    const auto range = [&](const Keys& keys, std::size_t part) {
      std::uint64_t* const begin = at(keys, part);
      return Span<const std::uint64_t>(
          begin, static_cast<std::size_t>(at(keys, part + 1) - begin));
    };
    RunParts(parts, [&](std::size_t part) {
      parts_[part].Merge({range(old, part), range(found, part)});
    });
    Keys now(state_.options.memory);
    Append(parts, &PairUpdate::now, now);
    Append(parts, &PairUpdate::began, began);
    Append(parts, &PairUpdate::ended, ended);
    state_.candidates.Swap(now);
    state_.pairs += began.size();
    state_.pairs -= ended.size();
  }

 private:
  static constexpr std::size_t kMostParts = 16;
  static constexpr std::size_t kMostBlocks = 64;  // of a part, if it can be
  static constexpr std::size_t kMostKeys = 8192;
  // With more changes, all pairs of the tree take less time.
  static constexpr std::size_t kShareOfSet = 4;

  static std::size_t PartsFor(std::size_t count) {
    return std::clamp<std::size_t>(count, 1, kMostParts);
  }

  [[gnu::noinline]] void Find(const BvhPairKernels* kernels) {
    if (is_of_set_) {
      List<std::uint32_t> ids(state_.options.memory);
      ids.Reserve(changed_.size());
      changed_.ForEach([&](std::uint32_t id) {
        if (version_.Find(id) != nullptr) ids.Push(id);
      });
      const Span<const std::uint32_t> set = ids;
      parts_[0].Find(kernels, &set, PairOptions());
    } else {
      RunParts(find_parts_, [&](std::size_t part) {
        PairOptions options;
        options.begin = blocks_ * part / find_parts_;
        options.end = blocks_ * (part + 1) / find_parts_;
        parts_[part].Find(kernels, nullptr, options);
      });
    }
    parts_[0].FindPending();
  }

  // A part for which there was no memory runs again, in this thread, and throws
  // if there is still none.
  template <typename Function>
  void RunParts(std::size_t parts, const Function& function) {
#if defined(__cpp_exceptions)
    std::array<bool, kMostParts> has_failed{};
    run_(parts, [&](std::size_t part) {
      try {
        function(part);
      } catch (const std::bad_alloc&) {
        has_failed[part] = true;
      }
    });
    for (std::size_t part = 0; part < parts; ++part) {
      if (has_failed[part]) function(part);
    }
#else
    run_(parts, function);
#endif
  }

  // Moves the lists of the parts to an empty one.
  void Append(std::size_t parts, Keys& (PairUpdate::*keys)(), Keys& to) {
    if (parts == 1) return to.Swap((parts_[0].*keys)());
    std::size_t count = 0;
    for (std::size_t p = 0; p < parts; ++p) {
      count += (parts_[p].*keys)().size();
    }
    to.Reserve(count);
    for (std::size_t p = 0; p < parts; ++p) {
      const Keys& from = (parts_[p].*keys)();
      std::copy(from.begin(), from.end(), to.end());
      to.SetSize(to.size() + from.size());
    }
  }

  BroadPhaseState& state_;
  const Version& version_;
  const IdSet& changed_;
  const Runner& run_;
  const bool is_of_set_;
  const std::size_t blocks_;
  const std::size_t find_parts_;
  const std::size_t merge_parts_;
  LockedMemory memory_;  // of the parts
  const Scratch scratch_;
  PairUpdate* const parts_;
  std::size_t made_ = 0;
};

// The masks of a call for the bodies of its set.
class CallMasks {
 public:
  CallMasks(const MemoryResource& memory, Span<const std::uint32_t> ids,
            Span<const std::uint64_t> masks)
      : order_(memory), masks_(masks) {
    order_.Reserve(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
      order_.Push(std::uint64_t{ids[i]} << 32 | i);
    }
    Sort(memory, order_);
  }

  // Whether a body of the set wants another one.
  bool Wants(std::uint32_t id, const BodyMasks& other) const {
    const std::uint64_t* of =
        std::lower_bound(order_.begin(), order_.end(), std::uint64_t{id} << 32);
    for (; of != order_.end() && *of >> 32 == id; ++of) {
      if (HasMask(other, masks_[static_cast<std::uint32_t>(*of)])) return true;
    }
    return false;
  }

 private:
  Keys order_;  // the id, then its place in the list
  Span<const std::uint64_t> masks_;
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
    const auto read = [&](bool has_masks) {
      return state_.bodies.Read(a, of_a, has_masks) &&
             state_.bodies.Read(b, of_b, has_masks);
    };
    // Most candidates end here if the bounds in the tree are larger.
    if (state_.has_margin && margin_ == 0 &&
        (!read(false) ||
         !DoOverlap(of_a.planes, of_b.planes, state_.shape.axes))) {
      return true;
    }
    if (!read(true)) return true;
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
                                 const PairEvents& events, const Runner& run) {
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
    PairUpdates(state, *version, changed, touched, run)
        .Run(kernels, began, ended);
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
