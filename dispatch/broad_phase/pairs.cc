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

// The rules of pairs.
class PairTest {
 public:
  explicit PairTest(const BroadPhaseState& state) : state_(state) {}

  static bool MasksMatch(const Body& a, const Body& b) {
    return (a.masks.category & b.masks.collides_with) != 0 &&
           (b.masks.category & a.masks.collides_with) != 0;
  }
  bool CanBe(const Body& a, const Body& b) const {
    return state_.options.filter.keep != nullptr || MasksMatch(a, b);
  }
  // Of two that can be a pair and overlap.
  bool IsKept(std::uint32_t a, const Body& of_a, std::uint32_t b,
              const Body& of_b) const {
    const PairFilter& filter = state_.options.filter;
    if (filter.keep == nullptr) return true;
    const WithoutRacyReads reads;
    return filter.keep(filter.context, a, b, MasksMatch(of_a, of_b));
  }
  // With a NaN, as with infinities that are equal, they do.
  bool Overlap(const Body& a, const Body& b) const {
    const std::size_t axes = state_.shape.axes;
    return kernels::InDefaultFpMode([&] {
      bool is_apart = false;
      for (std::size_t k = 0; k < axes; ++k) {
        is_apart |= a.planes[k] > b.planes[axes + k];
        is_apart |= b.planes[k] > a.planes[axes + k];
      }
      return !is_apart;
    });
  }

  // Appends two bodies whose bounds in the tree overlap, unless they cannot be
  // a pair.
  void Add(std::uint32_t a, std::uint32_t b, Keys& keys) const {
    Body of_a;
    Body of_b;
    if (!state_.bodies.Read(a, of_a) || !state_.bodies.Read(b, of_b) ||
        !CanBe(of_a, of_b)) {
      return;
    }
    keys.Push(KeyOf(a, b, Overlap(of_a, of_b) && IsKept(a, of_a, b, of_b)));
  }
  // A candidate whose masks have not changed.
  std::uint64_t Again(std::uint64_t key) const {
    const std::uint32_t a = LowOf(key);
    const std::uint32_t b = HighOf(key);
    Body of_a;
    Body of_b;
    const bool is_pair = state_.bodies.Read(a, of_a) &&
                         state_.bodies.Read(b, of_b) && Overlap(of_a, of_b) &&
                         (IsPair(key) || IsKept(a, of_a, b, of_b));
    return KeyOf(a, b, is_pair);
  }

 private:
  const BroadPhaseState& state_;
};

// The candidates of the bodies of a set. A body that is in no tree yet has its
// own bound instead of one in the tree.
class CandidateFinder {
 public:
  CandidateFinder(const BroadPhaseState& state, const Version& version,
                  const IdSet& set, Keys& found)
      : state_(state),
        version_(version),
        set_(set),
        found_(found),
        test_(state) {}

  void Find(const BvhPairKernels* kernels) {
    const WithRacyReads reads;
    List<std::uint32_t> ids(state_.options.memory);
    const std::size_t count = set_.size();
    if (count == 0) return;
    if (4 * count < version_.tree.size()) {
      ids.Reserve(count);
      set_.ForEach([&](std::uint32_t id) {
        if (version_.tree.Has(id)) ids.Push(id);
      });
    }
    const Span<const std::uint32_t> set = ids;
    if (version_.tree.size() > 0 &&
        (ids.size() > 0 || 4 * count >= version_.tree.size())) {
      BvhForEachPair(
          {kernels, &version_.tree, nullptr, ids.size() > 0 ? &set : nullptr},
          [](void* self, Span<const IdPair> pairs) {
            static_cast<const CandidateFinder*>(self)->Add(pairs);
            return true;
          },
          this, PairOptions());
    }
    for (std::size_t i = 0; i < version_.PendingCount(); ++i) AddPending(i);
    Sort(state_.options.memory, found_);
  }

 private:
  void Add(Span<const IdPair> pairs) const {
    for (const IdPair& pair : pairs) {
      state_.bodies.Prefetch(pair.a);
      state_.bodies.Prefetch(pair.b);
    }
    for (const IdPair& pair : pairs) Add(pair.a, pair.b);
  }
  void Add(std::uint32_t a, std::uint32_t b) const {
    if (set_.Has(a) || set_.Has(b)) test_.Add(a, b, found_);
  }

  [[gnu::noinline]] void AddPending(std::size_t i) {
    const std::uint32_t id = version_.Pending(i);
    for (std::size_t j = 0; j < i; ++j) Add(version_.Pending(j), id);
    Body body;
    if (!state_.bodies.Read(id, body)) return;
    struct Call {
      const CandidateFinder& self;
      std::uint32_t id;
    } call{*this, id};
    BvhForEach(
        version_.tree, {body.planes, 1},
        [](void* context, Span<const std::uint32_t> others) {
          const Call& of = *static_cast<const Call*>(context);
          for (const std::uint32_t other : others) {
            of.self.Add(of.id, other);
          }
          return true;
        },
        &call, QueryOptions());
  }

  const BroadPhaseState& state_;
  const Version& version_;
  const IdSet& set_;
  Keys& found_;
  const PairTest test_;
};

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
    TakenMarks touched(state, Bodies::kTouched);
    changed.Take();
    touched.Take();
    const Held version(state);
    Keys found(memory);
    CandidateFinder(state, *version, changed, found).Find(kernels);

    Keys now(memory);
    now.Reserve(state.candidates.size() + found.size());
    std::size_t pairs = 0;
    const auto add = [&](std::uint64_t key) {
      now.Push(key);
      pairs += IsPair(key) ? 1 : 0;
    };
    const std::uint64_t* next = found.begin();
    const auto begin_before = [&](std::uint64_t key) {
      for (; next != found.end() && *next < key; ++next) {
        if (IsPair(*next)) began.Push(*next);
        add(*next);
      }
    };
    const PairTest test(state);
    for (const std::uint64_t old : state.candidates) {
      const std::uint64_t key = old & ~std::uint64_t{1};
      begin_before(key);
      const std::uint32_t a = LowOf(key);
      const std::uint32_t b = HighOf(key);
      std::uint64_t is = old;
      if (next != found.end() && *next - key < 2) {
        is = *next++;
      } else if (changed.Has(a) || changed.Has(b)) {
        if (IsPair(old)) ended.Push(old);
        continue;
      } else if (touched.Has(a) || touched.Has(b)) {
        is = test.Again(old);
      }
      if (is != old) (IsPair(is) ? began : ended).Push(is);
      add(is);
    }
    begin_before(~std::uint64_t{0});
    state.candidates.Swap(now);
    state.pairs = pairs;
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
