// Pairs of a broad phase. Pairs of the tree's bounds are candidates, which are
// tested again by the bodies' own bounds.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <new>

#include "dispatch/broad_phase/exact.h"
#include "dispatch/broad_phase/state.h"
#include "dispatch/bvh/layout.h"
#include "dispatch/exact/default_fp_mode.h"

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
  if (std::is_sorted(keys.begin(), keys.end())) return;
  if (keys.size() < kFew) return std::sort(keys.begin(), keys.end());
  std::uint64_t different = 0;
  for (const std::uint64_t key : keys) different |= key ^ keys[0];
  Keys sorted(memory);
  sorted.Resize(keys.size(), 0);
  for (int shift = 0; shift < 64; shift += 8) {
    const auto digit = [shift](std::uint64_t key) {
      return static_cast<std::uint8_t>(key >> shift);
    };
    if (digit(different) == 0) continue;
    std::array<std::size_t, 256> places{};
    for (const std::uint64_t key : keys) ++places[digit(key)];
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

// The marks of all bodies that UpdatePairs() takes, a byte for each. The bodies
// get them back unless Keep() was called.
class PairMarks {
 public:
  explicit PairMarks(BroadPhaseState& state)
      : state_(state), marks_(state.options.memory) {
    marks_.Resize((state.id_limit + 7) / 8, 0);
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      marks_[i] = state.bodies.TakePairMarks(i);
      touched_count_ += CountOf(i, Bodies::kTouched);
      changed_count_ += CountOf(i, Bodies::kNewPairs);
    }
  }
  PairMarks(const PairMarks&) = delete;
  PairMarks& operator=(const PairMarks&) = delete;
  ~PairMarks() {
    if (is_kept_) return;
    ForEach(Bodies::kNewPairs, [&](std::uint32_t id) {
      state_.bodies.AddMark(id, Bodies::kNewPairs);
    });
    ForEach(Bodies::kTouched,
            [&](std::uint32_t id) { state_.bodies.Touch(id); });
  }
  void Keep() { is_kept_ = true; }

  std::uint8_t Of(std::uint32_t id) const {
    return reinterpret_cast<const std::uint8_t*>(marks_.data())[id];
  }
  std::size_t changed_count() const { return changed_count_; }
  bool empty() const { return changed_count_ + touched_count_ == 0; }
  template <typename Visit>
  void ForEach(Bodies::Mark mark, const Visit& visit) const {
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      if ((marks_[i] & Bodies::EightOf(mark)) == 0) continue;
      for (std::size_t id = 8 * i; id < 8 * i + 8; ++id) {
        const auto it = static_cast<std::uint32_t>(id);
        if ((Of(it) & mark) != 0) visit(it);
      }
    }
  }

 private:
  // Of eight bodies. Without the instruction, popcount is a call.
  std::size_t CountOf(std::size_t i, Bodies::Mark mark) const {
    constexpr std::uint64_t kOnes = 0x0101010101010101;
    return (marks_[i] / mark & kOnes) * kOnes >> 56;
  }

  BroadPhaseState& state_;
  List<std::uint64_t> marks_;
  std::size_t changed_count_ = 0;
  std::size_t touched_count_ = 0;
  bool is_kept_ = false;
};

// Pairs that are tested together.
constexpr std::size_t kSome = 64;

// A part of an update of pairs.
class PairUpdate {
 public:
  PairUpdate(const BroadPhaseState& state, const Version& version,
             const PairMarks& marks, const MemoryResource& memory)
      : state_(state),
        version_(version),
        marks_(marks),
        found_(memory),
        kept_(memory),
        dropped_(memory),
        began_(memory),
        ended_(memory) {}

  // Candidates of bodies that changed, and of the others.
  Keys& found() { return found_; }
  Keys& kept() { return kept_; }
  // Pairs before, of bodies that changed.
  Keys& dropped() { return dropped_; }
  // Of the others.
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
  // Of candidates, keeps those of bodies that did not change, and tests again
  // those of bodies that moved inside their bounds.
  void Retest(Span<const std::uint64_t> candidates) {
    kept_.Clear();
    dropped_.Clear();
    began_.Clear();
    ended_.Clear();
    kept_.Reserve(candidates.size() + found_.size());
    const WithRacyReads reads;
    dispatch::InDefaultFpMode([&] {
      WithAxes(state_.shape.axes, [&](auto axes) {
        for (std::size_t i = 0; i < candidates.size(); i += kSome) {
          RetestSome<decltype(axes)::value>(
              {candidates.data() + i, std::min(kSome, candidates.size() - i)});
        }
      });
    });
  }

 private:
  static unsigned BitOf(unsigned marks, Bodies::Mark mark) {
    return marks / mark & 1;
  }

  [[gnu::noinline]] void Add(Span<const IdPair> pairs) {
    for (std::size_t i = 0; i < pairs.size(); i += kSome) {
      AddSome({pairs.data() + i, std::min(kSome, pairs.size() - i)});
    }
  }
  void Add(std::uint32_t a, std::uint32_t b) {
    const IdPair pair = {a, b};
    Add({&pair, 1});
  }
  // Two bodies whose bounds in the tree overlap. A body that is in no tree has
  // its own bound instead. Nothing predicts which have changed, so there is no
  // branch for it.
  void AddSome(Span<const IdPair> pairs) {
    IdPair some[kSome];
    std::size_t count = 0;
    for (const IdPair& pair : pairs) {
      some[count] = pair;
      count += BitOf(unsigned{marks_.Of(pair.a)} | marks_.Of(pair.b),
                     Bodies::kNewPairs);
    }
    if (state_.HasMasks() || state_.options.filter.keep != nullptr) {
      count = Filter(some, count);
    }
    found_.Reserve(found_.size() + count);
    dispatch::InDefaultFpMode([&] {
      WithAxes(state_.shape.axes, [&](auto axes) {
        for (std::size_t i = 0; i < count; ++i) {
          const auto [a, b] = some[i];
          const bool is_pair =
              state_.bodies.DoOverlap<decltype(axes)::value>(a, b);
          found_.Push(KeyOf(a, b, is_pair));
        }
      });
    });
  }
  // Those that the masks and the filter keep, first. Returns how many.
  [[gnu::noinline]] std::size_t Filter(IdPair* pairs, std::size_t count) const {
    const PairFilter& filter = state_.options.filter;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto [a, b] = pairs[i];
      Body of_a;
      Body of_b;
      if (!state_.bodies.Read(a, of_a) || !state_.bodies.Read(b, of_b))
        continue;
      bool is_kept = MasksMatch(of_a, of_b);
      if (filter.keep != nullptr) {
        const WithoutRacyReads reads;
        is_kept = filter.keep(filter.context, a, b, is_kept);
      }
      pairs[kept] = {a, b};
      kept += is_kept ? 1 : 0;
    }
    return kept;
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

  // The lists have room. Without branches that nothing predicts.
  template <std::size_t kAxes>
  void RetestSome(Span<const std::uint64_t> candidates) {
    std::uint64_t* to = kept_.end();
    std::uint64_t* again[kSome];
    std::uint64_t dropped[kSome];
    std::size_t again_count = 0;
    std::size_t dropped_count = 0;
    for (const std::uint64_t key : candidates) {
      const unsigned marks = marks_.Of(LowOf(key)) | marks_.Of(HighOf(key));
      const unsigned is_changed = BitOf(marks, Bodies::kNewPairs);
      *to = key;
      again[again_count] = to;
      dropped[dropped_count] = key;
      to += is_changed ^ 1;
      again_count += BitOf(marks, Bodies::kTouched) & (is_changed ^ 1);
      dropped_count += is_changed & key;
    }
    kept_.SetSize(static_cast<std::size_t>(to - kept_.begin()));
    for (std::size_t i = 0; i < dropped_count; ++i) dropped_.Push(dropped[i]);
    for (std::size_t i = 0; i < again_count; ++i) {
      const std::uint64_t old = *again[i];
      const bool is_pair =
          state_.bodies.DoOverlap<kAxes>(LowOf(old), HighOf(old));
      const std::uint64_t now = (old & ~std::uint64_t{1}) | (is_pair ? 1 : 0);
      *again[i] = now;
      if (now != old) (IsPair(now) ? began_ : ended_).Push(now);
    }
  }

  const BroadPhaseState& state_;
  const Version& version_;
  const PairMarks& marks_;
  Keys found_;
  Keys kept_;
  Keys dropped_;
  Keys began_;
  Keys ended_;
};

// Appends those of one list that are not in the other. Both ascend.
void AppendMissing(const Keys& of, const Keys& other, Keys& to) {
  std::size_t next = 0;
  for (const std::uint64_t key : of) {
    while (next < other.size() && other[next] < key) ++next;
    if (next == other.size() || other[next] != key) to.Push(key);
  }
}

// All of an update of pairs. The parts do not depend on the threads.
class PairUpdates {
 public:
  PairUpdates(BroadPhaseState& state, const Version& version,
              const PairMarks& marks, const Runner& run)
      : state_(state),
        version_(version),
        marks_(marks),
        run_(run),
        is_of_set_(kShareOfSet * marks.changed_count() < version.tree.size()),
        blocks_(BlocksOf(version.tree.ids().size())),
        find_parts_(is_of_set_ ? 1 : PartsFor(blocks_ / kMostBlocks)),
        retest_parts_(PartsFor(state.candidates.size() / kMostKeys)),
        part_count_(std::max(find_parts_, retest_parts_)),
        memory_(state.options.memory),
        scratch_(state.options.memory,
                 part_count_ == 1 ? 0 : part_count_ * sizeof(PairUpdate)),
        parts_(reinterpret_cast<PairUpdate*>(
            part_count_ == 1 ? one_part_ : scratch_.data())) {
    const MemoryResource memory =
        part_count_ == 1 ? state.options.memory : memory_.resource();
    for (std::size_t p = 0; p < part_count_; ++p) {
      new (parts_ + p) PairUpdate(state, version, marks, memory);
    }
  }
  PairUpdates(const PairUpdates&) = delete;
  PairUpdates& operator=(const PairUpdates&) = delete;
  ~PairUpdates() { std::destroy_n(parts_, part_count_); }

  void Run(const BvhPairKernels* kernels, Keys& began, Keys& ended) {
    const MemoryResource& memory = state_.options.memory;
    if (marks_.changed_count() > 0) Find(kernels);
    const Keys& old = state_.candidates;
    const std::size_t parts = retest_parts_;
    RunParts(parts, [&](std::size_t part) {
      const std::size_t begin = old.size() * part / parts;
      const std::size_t end = old.size() * (part + 1) / parts;
      parts_[part].Retest({old.data() + begin, end - begin});
    });
    Keys now(memory);
    Take(&PairUpdate::kept, CountOf(&PairUpdate::found), now);
    Take(&PairUpdate::began, 0, began);
    Take(&PairUpdate::ended, 0, ended);
    if (marks_.changed_count() > 0) {
      Keys found(memory);
      Take(&PairUpdate::found, 0, found);
      // So that those of the next call are sorted, if all bodies change.
      if (!state_.has_margin) Sort(memory, found);
      Append(found, now);
      Keys after(memory);
      after.Reserve(found.size());
      for (const std::uint64_t key : found) {
        if (IsPair(key)) after.Push(key);
      }
      Sort(memory, after);
      Keys before(memory);
      Take(&PairUpdate::dropped, 0, before);
      Sort(memory, before);
      AppendMissing(before, after, ended);
      AppendMissing(after, before, began);
    }
    Sort(memory, began);
    Sort(memory, ended);
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
      ids.Reserve(marks_.changed_count());
      marks_.ForEach(Bodies::kNewPairs, [&](std::uint32_t id) {
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

  using ListOf = Keys& (PairUpdate::*)();
  std::size_t CountOf(ListOf list) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < part_count_; ++p)
      count += (parts_[p].*list)().size();
    return count;
  }
  // Moves the keys of all parts to `to`, which must be empty, and reserves room
  // for `more`. Several parts use LockedMemory, so their keys are copied. The
  // list of one part has the room that it reserved.
  void Take(ListOf list, std::size_t more, Keys& to) {
    if (part_count_ == 1) return to.Swap((parts_[0].*list)());
    to.Reserve(CountOf(list) + more);
    for (std::size_t p = 0; p < part_count_; ++p)
      Append((parts_[p].*list)(), to);
  }
  // `to` has room.
  static void Append(const Keys& from, Keys& to) {
    std::copy(from.begin(), from.end(), to.end());
    to.SetSize(to.size() + from.size());
  }

  BroadPhaseState& state_;
  const Version& version_;
  const PairMarks& marks_;
  const Runner& run_;
  const bool is_of_set_;
  const std::size_t blocks_;
  const std::size_t find_parts_;
  const std::size_t retest_parts_;
  const std::size_t part_count_;
  LockedMemory memory_;  // of several parts
  const Scratch scratch_;
  alignas(PairUpdate) std::byte one_part_[sizeof(PairUpdate)];
  PairUpdate* const parts_;
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
        has_margin_(IsMargin(margin)),
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
      for (std::size_t i = 0; i < pairs.size() && goes_on; i += kSome) {
        goes_on =
            TestSome({pairs.data() + i, std::min(kSome, pairs.size() - i)});
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
    dispatch::InDefaultFpMode([&] { Grow(body.planes); });
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
    if (!has_margin_) return;
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

  // Calls the function for those that are pairs. Returns whether to go on. Most
  // candidates are none if the bounds in the tree are larger: they are tested
  // together.
  [[gnu::noinline]] bool TestSome(Span<const IdPair> pairs) {
    IdPair some[kSome];
    std::size_t count = 0;
    if (!has_margin_) {
      dispatch::InDefaultFpMode([&] {
        WithAxes(state_.shape.axes, [&](auto axes) {
          for (const IdPair& pair : pairs) {
            some[count] = pair;
            count +=
                state_.bodies.DoOverlap<decltype(axes)::value>(pair.a, pair.b)
                    ? 1
                    : 0;
          }
        });
      });
    } else {
      count = pairs.size();
      std::copy(pairs.begin(), pairs.end(), some);
    }
    const bool is_tested = !has_margin_ && masks_ == nullptr &&
                           !state_.HasMasks() &&
                           state_.options.filter.keep == nullptr;
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_tested) {
        if (!Test(some[i].a, some[i].b)) return false;
        continue;
      }
      const WithoutRacyReads reads;
      if (!function_(context_, some[i].a, some[i].b)) return false;
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
    if (!dispatch::InDefaultFpMode([&] { return Overlap(of_a, of_b); })) {
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
  bool has_margin_;
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
    PairMarks marks(state);
    if (marks.empty()) return;
    const Held version(state);
    PairUpdates(state, *version, marks, run).Run(kernels, began, ended);
    marks.Keep();
  }
  for (const std::uint64_t key : ended) {
    events.ended(events.context, LowOf(key), HighOf(key));
  }
  for (const std::uint64_t key : began) {
    events.began(events.context, LowOf(key), HighOf(key));
  }
}

}  // namespace halfspace::detail
