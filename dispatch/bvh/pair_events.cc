// PairEvents: a search for pairs, and the difference to the pairs before.
#include "halfspace/pair_events.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>
#include <string>
#include <tuple>

#include "dispatch/bvh/pairs.h"
#include "dispatch/bvh/scratch.h"
#include "dispatch/bvh/tree.h"
#include "dispatch/default_fp_mode.h"
#include "dispatch/errors/error.h"
#include "dispatch/errors/memory_checks.h"
#include "dispatch/errors/number_checks.h"
#include "dispatch/targets/chosen_target.h"
#include "halfspace/detail/plane_arrays.h"
#include "kernels/compiler.h"
#include "kernels/results.h"

namespace halfspace::detail {

PairList::PairList(const PairList& other, const MemoryResource& memory)
    : PairList(memory) {
  Append(other.span());
}

PairList::~PairList() {
  if (data_ != nullptr) FreeBlock(memory_, data_, bytes());
}

void PairList::Grow(std::size_t count) {
  count = std::max(count, capacity_ + capacity_ / 2);
  auto* const data =
      static_cast<IdPair*>(AllocateBlock(memory_, count * sizeof(IdPair)));
  std::copy_n(data_, size_, data);
  if (data_ != nullptr) FreeBlock(memory_, data_, bytes());
  data_ = data;
  capacity_ = count;
}

namespace {

constexpr const char* kUpdate = "PairEvents::Update";

std::uint64_t BitsOf(const IdPair& pair) {
  return kernels::BitCast<std::uint64_t>(pair);
}
std::uint64_t KeyOf(const IdPair& pair) {
  return std::uint64_t{pair.a} << 32 | pair.b;
}
bool IsLess(const IdPair& left, const IdPair& right) {
  return KeyOf(left) < KeyOf(right);
}
// The upper `bits` bits of a product, which depend on all bits of the pair.
std::size_t HashOf(const IdPair& pair, int bits) {
  return static_cast<std::size_t>(BitsOf(pair) * 0x9E3779B97F4A7C15 >>
                                  (64 - bits));
}

// Appends pairs to a list, the lesser id first. The filter runs in the
// floating-point mode of the caller.
class ListSink : public Results<IdPair> {
 public:
  ListSink(PairList& list, const PairListFilter& filter,
           dispatch::DefaultFpMode& mode)
      : Results<IdPair>{}, list_(list), filter_(filter), mode_(mode) {
    flush = [](Results<IdPair>& results) {
      static_cast<ListSink&>(results).Flush();
      static_cast<ListSink&>(results).Use();
      return true;
    };
    Use();
  }

  void Flush() {
    const auto count = static_cast<std::size_t>(next - begin);
    for (IdPair* pair = begin; pair != next; ++pair) {
      *pair = {std::min(pair->a, pair->b), std::max(pair->a, pair->b)};
    }
    std::size_t kept = count;
    if (filter_.keep != nullptr && count > 0) {
      kept = mode_.Outside([&] {
        return filter_.keep(filter_.context, {begin, count});
      });
    }
    list_.SetSize(list_.size() + kept);
    flushed += count;
    begin = next = nullptr;
  }

 private:
  // Small, so that the pairs are still in cache when they are read again.
  static constexpr std::size_t kRoom = 512;

  void Use() {
    list_.Reserve(list_.size() + kRoom);
    begin = next = list_.end();
    full = begin + (kRoom - kMostAtOnce + 1);
  }

  PairList& list_;
  const PairListFilter& filter_;
  dispatch::DefaultFpMode& mode_;
};

// The memory resource of the caller, used by several threads under a lock.
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

// A search, in parts if there is a runner.
class Search {
 public:
  Search(const PairSources& sources, const PairEventOptions& options,
         const PairListFilter& filter)
      : sources_(sources),
        filter_(filter),
        run_(options.run),
        options_{.mask = options.mask,
                 .margin = options.margin,
                 .target = options.target} {}

  // Finds the pairs, about `expected` of them. The result does not depend on
  // the number of parts.
  void Run(std::size_t expected, PairList& found) const {
    const std::size_t parts = PartCount();
    if (parts == 1) {
      found.Reserve(expected + expected / 8);
      return Find(0, 1, found);
    }
    RunParts(parts, expected, found);
  }

 private:
  static constexpr std::size_t kMostParts = 16;

  std::size_t blocks() const {
    return BlocksOf(sources_.a->levels().level[0].size);
  }

  // Each part builds the set again, in memory of the world's resource, which
  // must not be used by several threads.
  std::size_t PartCount() const {
    if (!run_) return 1;
    const bool is_of_set = sources_.ids != nullptr;
    if (is_of_set && sources_.a->memory() != MemoryResource()) return 1;
    const std::size_t count =
        is_of_set ? sources_.ids->size() / 1024 : blocks() / 32;
    return std::clamp<std::size_t>(count, 1, kMostParts);
  }

  void Find(std::size_t part, std::size_t parts, PairList& found) const {
    PairOptions options = options_;
    options.begin = blocks() * part / parts;
    options.end = blocks() * (part + 1) / parts;
    // Each thread has its own mode.
    dispatch::DefaultFpMode mode;
    ListSink sink(found, filter_, mode);
    FindPairs(sources_, options, kUpdate, sink);
    sink.Flush();
  }

  HALFSPACE_NOINLINE void RunParts(std::size_t parts, std::size_t expected,
                                   PairList& found) const {
    LockedMemory memory(found.memory());
    struct Part {
      PairList found;
      bool has_failed = false;
    };
    BlockVector<Part> all(BlockAllocator<Part>(found.memory()));
    all.reserve(parts);
    for (std::size_t p = 0; p < parts; ++p) {
      all.push_back({PairList(memory.resource())});
    }
    const auto find = [&](std::size_t p) {
      all[p].found.SetSize(0);
      all[p].found.Reserve(expected / parts + expected / 8);
      Find(p, parts, all[p].found);
    };
#if defined(__cpp_exceptions)
    // If a part has no memory, it runs again on this thread, and throws if
    // there is still no memory.
    run_(parts, [&](std::size_t p) {
      try {
        find(p);
      } catch (const std::bad_alloc&) {
        all[p].has_failed = true;
      }
    });
    for (std::size_t p = 0; p < parts; ++p) {
      if (all[p].has_failed) find(p);
    }
#else
    run_(parts, find);
#endif
    std::size_t count = 0;
    for (const Part& part : all) count += part.found.size();
    found.Reserve(count);
    for (const Part& part : all) found.Append(part.found.span());
  }

  const PairSources& sources_;
  const PairListFilter& filter_;
  const Runner& run_;
  PairOptions options_;
};

// Sorts by a, then by b. A radix sort by `a` comes first, because few pairs
// have the same `a`.
void Sort(PairList& pairs) {
  constexpr std::size_t kFew = 64;
  if (pairs.size() <= kFew)
    return std::sort(pairs.begin(), pairs.end(), IsLess);
  std::uint32_t different = 0;
  for (const IdPair& pair : pairs) different |= pair.a ^ pairs.data()->a;
  PairList sorted(pairs.memory());
  sorted.Reserve(pairs.size());
  sorted.SetSize(pairs.size());
  for (int shift = 0; shift < 32; shift += 8) {
    const auto digit = [shift](std::uint32_t id) {
      return static_cast<std::uint8_t>(id >> shift);
    };
    if (digit(different) == 0) continue;
    std::array<std::size_t, 256> places{};
    for (const IdPair& pair : pairs) ++places[digit(pair.a)];
    std::size_t begin = 0;
    for (std::size_t& place : places) {
      const std::size_t count = place;
      place = begin;
      begin += count;
    }
    for (const IdPair& pair : pairs) {
      sorted.data()[places[digit(pair.a)]++] = pair;
    }
    swap(pairs, sorted);
  }
  for (IdPair* begin = pairs.begin(); begin != pairs.end();) {
    IdPair* end = begin + 1;
    while (end != pairs.end() && end->a == begin->a) ++end;
    if (end - begin > 1) std::sort(begin, end, IsLess);
    begin = end;
  }
}

void CheckEachOnce(const char* call, Span<const IdPair> pairs,
                   const MemoryResource& memory) {
  PairList sorted(memory);
  sorted.Append(pairs);
  Sort(sorted);
  const IdPair* const twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice == sorted.end()) return;
  dispatch::ThrowInvalid(
      call, "pairs", "each pair once",
      std::to_string(twice->a) + " and " + std::to_string(twice->b) + " twice");
}

// The difference of two lists, each of which has a pair at most once. Lists
// that are nearly equal take little time, because runs of equal pairs are
// skipped.
class Difference {
 public:
  Difference(Span<const IdPair> before, Span<const IdPair> after,
             const MemoryResource& of_call)
      : before_(before), after_(after), ended_(of_call), began_(of_call) {}

  // Finds the pairs of only one list, sorted. If this throws, nothing has
  // changed.
  //
  // MatchSorted() alone would do. The two passes before it remove pairs of both
  // lists, so that fewer are sorted: MatchNear() those at nearly the same place
  // of both lists, MatchFar() those at any place.
  void Find(PairList& ended, PairList& began) {
    MatchNear();
    MatchFar();
    Sort(ended_);
    Sort(began_);
    MatchSorted();
    PairList its_ended(ended_, ended.memory());
    PairList its_began(began_, began.memory());
    swap(ended, its_ended);
    swap(began, its_began);
  }

 private:
  static constexpr std::size_t kWindow = 64;
  static constexpr int kWindowBits = 9;  // of the table's size

  // Appends the pairs of each list that are not near in the other one. Equal
  // pairs at the front of both lists are skipped. Then the next 64 pairs of one
  // list are looked up in a hash table of the next 64 of the other, and the
  // lists advance to the last pair of each that was found.
  void MatchNear() {
    std::uint8_t table[1 << kWindowBits] = {};
    ended_.Reserve(before_.size() / 4);
    began_.Reserve(after_.size() / 4);
    const IdPair* before = before_.begin();
    const IdPair* after = after_.begin();
    for (;;) {
      SkipEqual(before, after);
      const auto of_before = static_cast<std::size_t>(
          std::min<std::ptrdiff_t>(kWindow, before_.end() - before));
      const auto of_after = static_cast<std::size_t>(
          std::min<std::ptrdiff_t>(kWindow, after_.end() - after));
      if (of_before == 0 || of_after == 0) break;
      for (std::size_t i = 0; i < of_before; ++i) {
        table[HashOf(before[i], kWindowBits)] = static_cast<std::uint8_t>(i);
      }
      std::uint64_t is_in_after = 0;   // of those before
      std::uint64_t is_in_before = 0;  // of those after
      for (std::size_t i = 0; i < of_after; ++i) {
        const std::size_t at = table[HashOf(after[i], kWindowBits)];
        const std::uint64_t is_equal =
            at < of_before && BitsOf(before[at]) == BitsOf(after[i]) ? 1 : 0;
        is_in_after |= is_equal << at;
        is_in_before |= is_equal << i;
      }
      before += Take(before, of_before, is_in_after, ended_);
      after += Take(after, of_after, is_in_before, began_);
    }
    ended_.Append({before, static_cast<std::size_t>(before_.end() - before)});
    began_.Append({after, static_cast<std::size_t>(after_.end() - after)});
  }

  void SkipEqual(const IdPair*& before, const IdPair*& after) const {
    const auto differ = [](const IdPair& a, const IdPair& b) {
      return BitsOf(a) ^ BitsOf(b);
    };
    std::ptrdiff_t left =
        std::min(before_.end() - before, after_.end() - after);
    for (; left >= 4; left -= 4, before += 4, after += 4) {
      if ((differ(before[0], after[0]) | differ(before[1], after[1]) |
           differ(before[2], after[2]) | differ(before[3], after[3])) != 0) {
        break;
      }
    }
    for (; left > 0 && differ(*before, *after) == 0; --left) {
      ++before;
      ++after;
    }
  }

  // Appends the pairs that were not found, up to the last one that was found.
  // Returns how many pairs are done.
  static std::size_t Take(const IdPair* pairs, std::size_t count,
                          std::uint64_t found, PairList& to) {
    const std::size_t done =
        found == 0 ? count : static_cast<std::size_t>(std::bit_width(found));
    to.Reserve(to.size() + kWindow);
    std::uint64_t missing = ~found & ~std::uint64_t{0} >> (64 - done);
    for (; missing != 0; missing &= missing - 1) {
      to.Add(pairs[std::countr_zero(missing)]);
    }
    return done;
  }

  // Removes most pairs that are in both of the remaining lists. The hash table
  // has the last pair of each hash. Other pairs with the same hash stay in both
  // lists.
  void MatchFar() {
    constexpr std::size_t kFew = 32;
    const std::size_t count = ended_.size();
    if (count < kFew || began_.size() < kFew) return;
    const int bits = static_cast<int>(std::bit_width(count)) + 1;
    const Scratch scratch(ended_.memory(), sizeof(std::uint32_t) << bits);
    auto* const table = reinterpret_cast<std::uint32_t*>(scratch.data());
    std::fill_n(table, std::size_t{1} << bits, 0);
    IdPair* const ended = ended_.data();
    for (std::size_t i = 0; i < count; ++i) {
      table[HashOf(ended[i], bits)] = static_cast<std::uint32_t>(i);
    }
    constexpr IdPair kNone = {0, 0};  // a < b in a pair
    IdPair* to = began_.begin();
    for (const IdPair& pair : began_) {
      IdPair& other = ended[table[HashOf(pair, bits)]];
      const bool is_in_both = other == pair;
      other = is_in_both ? kNone : other;
      *to = pair;
      to += is_in_both ? 0 : 1;
    }
    began_.SetSize(static_cast<std::size_t>(to - began_.begin()));
    to = ended;
    for (const IdPair& pair : ended_) {
      *to = pair;
      to += pair == kNone ? 0 : 1;
    }
    ended_.SetSize(static_cast<std::size_t>(to - ended));
  }

  // Removes the pairs that are in both lists, which are sorted. A pair is
  // always written, and stays only if its list's end moves on: the comparisons
  // would be mispredicted.
  void MatchSorted() {
    const IdPair* ended = ended_.begin();
    const IdPair* began = began_.begin();
    IdPair* to_ended = ended_.begin();
    IdPair* to_began = began_.begin();
    while (ended != ended_.end() && began != began_.end()) {
      const std::uint64_t ended_key = KeyOf(*ended);
      const std::uint64_t began_key = KeyOf(*began);
      if (ended_key <= began_key) *to_ended = *ended++;
      if (began_key <= ended_key) *to_began = *began++;
      to_ended += ended_key < began_key ? 1 : 0;
      to_began += began_key < ended_key ? 1 : 0;
    }
    const IdPair* const ended_end = ended_.end();
    const IdPair* const began_end = began_.end();
    to_ended = std::copy(ended, ended_end, to_ended);
    to_began = std::copy(began, began_end, to_began);
    ended_.SetSize(static_cast<std::size_t>(to_ended - ended_.begin()));
    began_.SetSize(static_cast<std::size_t>(to_began - began_.begin()));
  }

  const Span<const IdPair> before_;
  const Span<const IdPair> after_;
  PairList ended_;
  PairList began_;
};

// One more than the greatest id of the pairs, and at least `least`. Objects of
// an altered blob have any ids. The limit of kNoId is kNoId, which fits 32
// bits, and for which an IdSet has room.
std::size_t LimitOf(Span<const IdPair> pairs, std::size_t least) {
  std::uint32_t greatest = 0;
  for (const IdPair& pair : pairs) greatest = std::max(greatest, pair.b);
  return std::max(least, std::size_t{std::max(greatest + 1, greatest)});
}

// A set of ids below a limit. Other ids are left out. It has a byte for each
// id, because a bit takes a third longer to read.
class IdSet {
 public:
  IdSet(const MemoryResource& memory, Span<const std::uint32_t> ids,
        std::size_t limit)
      : memory_(memory, limit + 1),
        has_(reinterpret_cast<std::uint8_t*>(memory_.data())) {
    std::memset(has_, 0, limit + 1);
    for (const std::uint32_t id : ids) {
      if (id < limit) has_[id] = 1;
    }
  }
  // Returns 1 if one id of the pair is in the set, and else 0. Both are below
  // the limit.
  std::uint8_t HasOne(const IdPair& pair) const {
    return has_[pair.a] | has_[pair.b];
  }

 private:
  Scratch memory_;
  std::uint8_t* has_;
};

// Moves the pairs with a changed object out of a list. The destructor moves
// them back, unless Keep() was called.
class Removal {
 public:
  Removal(PairList& pairs, const MemoryResource& memory)
      : pairs_(pairs), removed_(memory), size_(0) {}
  Removal(const Removal&) = delete;
  Removal& operator=(const Removal&) = delete;
  ~Removal() {
    std::copy(removed_.begin(), removed_.end(), pairs_.data() + size_);
  }

  void Run(const IdSet& changed, std::size_t expected) {
    constexpr std::size_t kSome = 1024;
    removed_.Reserve(expected + expected / 8);
    for (std::size_t i = 0; i < pairs_.size(); i += kSome) {
      const std::size_t count = std::min(kSome, pairs_.size() - i);
      removed_.Reserve(removed_.size() + count);
      RunSome(changed, pairs_.data() + i, count);
    }
  }
  void Keep() {
    pairs_.SetSize(size_);
    removed_.SetSize(0);
  }

  const PairList& removed() const { return removed_; }
  std::size_t size() const { return size_; }

 private:
  void RunSome(const IdSet& changed, const IdPair* from, std::size_t count) {
    constexpr std::size_t kGroup = 8;
    IdPair* kept = pairs_.data() + size_;
    IdPair* removed = removed_.end();
    // Without branches, because they would be mispredicted.
    const auto move = [&](const IdPair pair, std::uint8_t is_removed) {
      *removed = pair;
      *kept = pair;
      removed += is_removed;
      kept += is_removed ^ 1;
    };
    std::size_t i = 0;
    for (; i + kGroup <= count; i += kGroup) {
      std::array<std::uint8_t, kGroup> is_removed;
      std::uint8_t removes = 0;
      for (std::size_t k = 0; k < kGroup; ++k) {
        is_removed[k] = changed.HasOne(from[i + k]);
        removes |= is_removed[k];
      }
      if (removes == 0) {
        std::memmove(kept, from + i, kGroup * sizeof(IdPair));
        kept += kGroup;
        continue;
      }
      for (std::size_t k = 0; k < kGroup; ++k) move(from[i + k], is_removed[k]);
    }
    for (; i < count; ++i) move(from[i], changed.HasOne(from[i]));
    size_ = static_cast<std::size_t>(kept - pairs_.data());
    removed_.SetSize(static_cast<std::size_t>(removed - removed_.data()));
  }

  PairList& pairs_;
  PairList removed_;
  std::size_t size_;  // the number of pairs that stay
};

}  // namespace

void PairEventsCore::Update(const PairSources& sources,
                            const PairEventOptions& options,
                            const PairListFilter& filter) {
  // Only loaded pairs have greater ids. An IdSet would take memory for ids that
  // the world does not have.
  constexpr std::size_t kMostIds = std::size_t{1} << 20;
  // As the search does, but before anything is changed.
  dispatch::CheckFiniteLength(kUpdate, "options.margin", options.margin);
  std::ignore = dispatch::IndexOf(options.target, kUpdate);
  if (sources.ids != nullptr) {
    const Span<const std::uint32_t> ids = *sources.ids;
    dispatch::CheckMemory(kUpdate, "changed", ids.data(), ids.size(),
                          alignof(std::uint32_t));
    const std::size_t most_ids = kMostIds + 2 * sources.a->id_limit();
    if (IsSmallSet(ids.size(), sources.a->size()) && id_limit_ <= most_ids) {
      return UpdateSome(sources, options, filter);
    }
  }
  const PairSources all = {
      .kernels = sources.kernels, .a = sources.a, .b = nullptr, .ids = nullptr};
  UpdateAll(all, options, filter);
}

void PairEventsCore::UpdateAll(const PairSources& sources,
                               const PairEventOptions& options,
                               const PairListFilter& filter) {
  PairList now(memory());
  Search(sources, options, filter).Run(pairs_.size(), now);
  CallMemory of_call(memory());
  Difference(pairs_.span(), now.span(), of_call.resource())
      .Find(ended_, began_);
  swap(pairs_, now);
  id_limit_ = LimitOf(pairs_.span(), sources.a->id_limit());
}

void PairEventsCore::UpdateSome(const PairSources& sources,
                                const PairEventOptions& options,
                                const PairListFilter& filter) {
  const BvhTree& tree = *sources.a;
  const Span<const std::uint32_t> ids = *sources.ids;
  // The ids that objects still have.
  Span<const std::uint32_t> present = ids;
  const auto has = [&tree](std::uint32_t id) { return tree.Has(id); };
  const bool is_present = std::all_of(ids.begin(), ids.end(), has);
  CallMemory of_call(memory());
  const Scratch scratch(of_call.resource(),
                        is_present ? 0 : ids.size() * sizeof(ids[0]));
  if (!is_present) {
    auto* const some = reinterpret_cast<std::uint32_t*>(scratch.data());
    std::uint32_t* const end = std::copy_if(ids.begin(), ids.end(), some, has);
    present = {some, static_cast<std::size_t>(end - some)};
  }
  PairList found(of_call.resource());
  const PairSources of_present = {
      .kernels = sources.kernels, .a = &tree, .b = nullptr, .ids = &present};
  Search(of_present, options, filter).Run(0, found);
  const IdSet changed(of_call.resource(), ids, id_limit_);
  Removal removal(pairs_, of_call.resource());
  removal.Run(changed, found.size());
  pairs_.Reserve(removal.size() + found.size());
  Difference(removal.removed().span(), found.span(), of_call.resource())
      .Find(ended_, began_);
  removal.Keep();
  pairs_.Append(found.span());
  id_limit_ = LimitOf(found.span(), std::max(id_limit_, tree.id_limit()));
}

void PairEventsCore::Clear() { *this = PairEventsCore(memory()); }

void PairEventsCore::Load(Span<const IdPair> pairs) {
  constexpr const char* kCall = "PairEvents::Load";
  dispatch::CheckMemory(kCall, "pairs", pairs.data(), pairs.size(),
                        alignof(IdPair));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i];
    if (a >= b || b == kNoId) {
      dispatch::ThrowInvalid(kCall, "pairs", "a < b < 4294967295",
                             std::to_string(a) + " and " + std::to_string(b),
                             i);
    }
  }
  CheckEachOnce(kCall, pairs, memory());
  PairEventsCore loaded(memory());
  loaded.id_limit_ = LimitOf(pairs, 0);
  loaded.pairs_.Append(pairs);
  swap(*this, loaded);
}

}  // namespace halfspace::detail
