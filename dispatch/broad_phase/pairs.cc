// Pairs of a broad phase. Pairs of the tree's bounds are candidates, which are
// tested again by the bodies' own bounds.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "kernels/error.h"
#include "kernels/exact/default_fp_mode.h"
#include "kernels/memory_checks.h"

namespace halfspace::detail {
namespace {

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
    BlockVector<std::uint32_t> in_tree(
        BlockAllocator<std::uint32_t>(state.options.memory));
    in_tree.reserve(ids.size());
    for (const std::uint32_t id : ids) {
      if (version_.tree.Has(id)) {
        in_tree.push_back(id);
      } else {
        AddNew(id);
      }
    }
    if (!in_tree.empty() && !JoinTree(kernels, in_tree)) return;
    const std::size_t pending = version_.PendingCount();
    if (pending == 0) return;
    std::sort(new_, new_ + new_count_);
    new_count_ =
        static_cast<std::size_t>(std::unique(new_, new_ + new_count_) - new_);
    for (std::size_t i = 0; i < new_count_; ++i) {
      if (!JoinNew(new_[i], pending)) return;
    }
    std::sort(in_tree.begin(), in_tree.end());
    in_tree.erase(std::unique(in_tree.begin(), in_tree.end()), in_tree.end());
    for (std::size_t i = 0; i < pending; ++i) {
      const std::uint32_t id = version_.Pending(i);
      if (IsNewOfSet(id)) continue;
      for (const std::uint32_t other : in_tree) {
        if (!Test(other, id)) return;
      }
    }
  }

 private:
  // Ids are in the list once, so there are no more than it has, without those
  // that the caller gave twice.
  void AddNew(std::uint32_t id) {
    if (std::find(new_, new_ + new_count_, id) != new_ + new_count_) return;
    if (new_count_ < Version::kMostPending) new_[new_count_++] = id;
  }
  bool IsNewOfSet(std::uint32_t id) const {
    return std::binary_search(new_, new_ + new_count_, id);
  }

  // The pairs in the tree.
  bool JoinTree(const BvhPairKernels* kernels, Span<const std::uint32_t> ids) {
    PairOptions options;
    options.margin = margin_;
    bool goes_on = true;
    const auto call = [&](Span<const IdPair> pairs) {
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
  bool JoinNew(std::uint32_t id, std::size_t pending) {
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

  bool Overlap(const Body& a, const Body& b) const {
    const std::size_t axes = state_.shape.axes;
    for (std::size_t k = 0; k < axes; ++k) {
      const double margin = MarginOf(k);
      // With a NaN, as with infinities that are equal, it is not greater.
      if (double{a.planes[k]} - b.planes[axes + k] > margin) return false;
      if (double{b.planes[k]} - a.planes[axes + k] > margin) return false;
    }
    return true;
  }

  // Calls the function if the two are a pair. Returns whether to go on.
  bool Test(std::uint32_t a, std::uint32_t b) {
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
  const auto bits = std::bit_cast<std::uint32_t>(margin);
  if (bits << 1 != 0 && bits >= 0x7F800000) {
    kernels::ThrowInvalid(kCall, "margin",
                          "a finite number that is not negative",
                          std::to_string(margin));
  }
  const Held version(*state_);
  const WithRacyReads reads;
  PairFinder(*state_, *version, margin, function, context).Find(kernels, ids);
}

void BroadPhaseCore::UpdatePairs(const BvhPairKernels* kernels,
                                 const PairEvents& events) {
  BroadPhaseState& state = *state_;
  using Keys = BlockVector<std::uint64_t>;
  const BlockAllocator<std::uint64_t> memory(state.options.memory);
  Keys began(memory);
  Keys ended(memory);
  {
    const std::scoped_lock lock(state.mutex);
    TakenMarks changed(state, Bodies::kNewPairs);
    const Held version(state);
    BlockVector<std::uint32_t> ids(
        BlockAllocator<std::uint32_t>(state.options.memory));
    Keys is_changed(memory);
    ids.reserve(changed.ids().size());
    is_changed.resize((state.id_limit + 63) / 64);
    for (const std::uint32_t id : changed.ids()) {
      is_changed[id / 64] |= std::uint64_t{1} << id % 64;
      Body body;
      if (!state.bodies.Read(id, body)) continue;
      // A mover whose mark was taken may not have done this yet.
      version->Widen(id, body.planes, false);
      ids.push_back(id);
    }

    Keys found(memory);
    {
      const WithRacyReads reads;
      PairFinder(
          state, *version, 0,
          [](void* keys, std::uint32_t a, std::uint32_t b) {
            static_cast<Keys*>(keys)->push_back(KeyOf(a, b));
            return true;
          },
          &found)
          .Find(kernels, ids);
    }
    std::sort(found.begin(), found.end());

    const auto has_changed = [&](std::uint64_t key) {
      const auto has = [&](std::uint32_t id) {
        return (is_changed[id / 64] >> id % 64 & 1) != 0;
      };
      return has(LowOf(key)) || has(HighOf(key));
    };
    Keys now(memory);
    now.reserve(state.pairs.size() + found.size());
    auto next = found.begin();
    const auto begin_before = [&](std::uint64_t key) {
      for (; next != found.end() && *next < key; ++next) {
        began.push_back(*next);
        now.push_back(*next);
      }
    };
    for (const std::uint64_t key : state.pairs) {
      begin_before(key);
      const bool is_found = next != found.end() && *next == key;
      if (is_found) ++next;
      if (is_found || !has_changed(key)) {
        now.push_back(key);
      } else {
        ended.push_back(key);
      }
    }
    begin_before(~std::uint64_t{0});
    state.pairs.swap(now);
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
