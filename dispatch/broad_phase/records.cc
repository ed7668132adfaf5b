#include "dispatch/broad_phase/records.h"

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

std::uint64_t WordAt(const float* planes) {
  std::uint64_t word = 0;
  std::memcpy(&word, planes, sizeof(word));
  return word;
}

}  // namespace

Records::~Records() {
  GroupList* list = list_.load();
  ForEachGroup([&](std::size_t, Group& group) {
    for (const std::atomic<Word*>& records : group.records) {
      if (records.load() == nullptr) continue;
      FreeBlock(memory_, records.load(), 64 * words_ * sizeof(Word));
    }
    FreeBlock(memory_, &group, sizeof(Group));
  });
  while (list != nullptr) {
    GroupList* const older = list->older;
    FreeBlock(memory_, list,
              sizeof(GroupList) + list->count * sizeof(GroupSlot));
    list = older;
  }
}

std::size_t Records::FindAbsent(Span<const std::uint32_t> ids) const {
  std::uint32_t number = ~std::uint32_t{0};  // of 64 ids
  const Word* records = nullptr;
  std::size_t i = 0;
  for (; i < ids.size(); ++i) {
    if (ids[i] / 64 != number) {
      number = ids[i] / 64;
      records = Find(number * 64);
      if (records == nullptr) break;
    }
    const Word& record = records[ids[i] % 64 * words_];
    if ((record.load(std::memory_order_acquire) & kPresent) == 0) break;
  }
  return i;
}

bool Records::Read(std::uint32_t id, float* planes) const {
  const Word* const record = Find(id);
  if (record == nullptr) return false;
  std::uint64_t words[kMostBodyPlanes / 2];
  const std::uint64_t state = WithAxes(words_ - 1, [&](auto axes) {
    return Load(std::make_index_sequence<axes>(), *record, words);
  });
  std::memcpy(planes, words, (words_ - 1) * sizeof(std::uint64_t));
  return (state & kPresent) != 0;
}

// Marks bodies. Returns the bits of those that had marks before.
inline std::uint64_t Records::Mark(Group& group, std::size_t w,
                                   std::uint64_t bits) {
  const std::uint64_t before =
      group.marks[w].fetch_or(bits, std::memory_order_seq_cst);
  const std::uint64_t bit = std::uint64_t{1} << w;
  if ((group.some.load(std::memory_order_seq_cst) & bit) == 0) {
    group.some.fetch_or(bit, std::memory_order_seq_cst);
  }
  if (!has_marks_.load(std::memory_order_seq_cst)) {
    has_marks_.store(true, std::memory_order_seq_cst);
  }
  return before;
}

// Bodies with neighbouring ids get their marks by one atomic or. If only some
// of them moved, all of the next ones are written: a branch for each body would
// be mispredicted. If half of 65 536 bodies move, in no order, each takes 3.5
// ns instead of 8.2, and if all move 3.3 instead of 3.0 (3D boxes, Zen 5). The
// words of a record are a parameter pack, because a loop over an array takes
// twice the time.
template <std::size_t... kWord>
void Records::MoveEach(std::index_sequence<kWord...>,
                       Span<const std::uint32_t> ids, const float* planes) {
  constexpr std::size_t kWords = 1 + sizeof...(kWord);
  std::uint64_t writes_all = 0;  // or 1
  const std::uint32_t* id = ids.begin();
  while (id != ids.end()) {
    const std::uint32_t number = *id / 64;
    Group& group = *GroupAt(*id / kGroupIds);
    Word* const records =
        group.records[number % 64].load(std::memory_order_relaxed);
    std::uint64_t seen = 0;
    std::uint64_t moved = 0;
    // Until an id of another 64 bodies, or one that comes a second time.
    for (; id != ids.end() && *id / 64 == number; ++id) {
      const std::uint64_t bit = std::uint64_t{1} << *id % 64;
      if ((seen & bit) != 0) break;
      seen |= bit;
      Word* const record = records + *id % 64 * kWords;
      const auto move = [&](auto... words) {
        const std::uint64_t different =
            ((record[1 + kWord].load(std::memory_order_relaxed) ^ words) | ...);
        moved |= std::uint64_t{different != 0} << *id % 64;
        if ((different | writes_all) == 0) return;
        record->store(record->load(std::memory_order_relaxed) | kIsWritten,
                      std::memory_order_relaxed);
        // These stores release, so that they stay after the one before.
        (record[1 + kWord].store(words, std::memory_order_release), ...);
      };
      move(WordAt(planes + 2 * kWord)...);
      planes += 2 * sizeof...(kWord);
    }
    // Those that were written and have not moved.
    const std::uint64_t same = writes_all != 0 ? seen & ~moved : 0;
    for (std::uint64_t bits = same; bits != 0; bits &= bits - 1) {
      Word& record = records[LowestBit(bits) * kWords];
      record.store(record.load(std::memory_order_relaxed) - kIsWritten,
                   std::memory_order_release);
    }
    writes_all = std::uint64_t{moved != 0 && moved != seen};
    if (moved == 0) continue;
    const std::uint64_t old = Mark(group, number % 64, moved);
    const std::uint64_t stamp = (moved & ~old) != 0 ? TimeOfStamp() << 32 : 0;
    for (; moved != 0; moved &= moved - 1) {
      const std::size_t i = LowestBit(moved);
      Word& record = records[i * kWords];
      const std::uint64_t before = record.load(std::memory_order_relaxed);
      const std::uint64_t version =
          (before - kIsWritten + kOneWrite) & kVersion;
      record.store(((old >> i & 1) != 0 ? before & ~kVersion : stamp) | version,
                   std::memory_order_release);
    }
  }
}

void Records::Move(Span<const std::uint32_t> ids, const float* planes) {
  WithAxes(words_ - 1, [&](auto axes) {
    MoveEach(std::make_index_sequence<axes>(), ids, planes);
  });
}

std::size_t Records::TakeMarks() {
  std::size_t count = 0;
  time_.store(0, std::memory_order_seq_cst);
  has_marks_.store(false, std::memory_order_seq_cst);
  ForEachGroup([&](std::size_t, Group& group) {
    group.some_taken = group.some.load(std::memory_order_seq_cst);
    if (group.some_taken == 0) return;
    group.some_taken = group.some.exchange(0, std::memory_order_seq_cst);
    for (std::uint64_t some = group.some_taken; some != 0; some &= some - 1) {
      const std::size_t w = LowestBit(some);
      group.taken[w] = group.marks[w].exchange(0, std::memory_order_seq_cst);
      Add(kForPairs, group, w, group.taken[w]);
      Add(kForOrder, group, w, group.taken[w]);
      count += PopCount(group.taken[w]);
    }
  });
  return count;
}

void Records::Grow(std::size_t groups) {
  GroupList* const old = list_.load(std::memory_order_relaxed);
  if (group_count() >= groups) return;
  const std::size_t count =
      std::max(groups, old == nullptr ? std::size_t{1} : 2 * old->count);
  const std::size_t bytes = sizeof(GroupList) + count * sizeof(GroupSlot);
  auto* const list = new (AllocateBlock(memory_, bytes)) GroupList{old, count};
  bytes_ += bytes;
  for (std::size_t g = 0; g < count; ++g) {
    new (list->slots() + g)
        GroupSlot(old != nullptr && g < old->count ? GroupAt(g) : nullptr);
  }
  list_.store(list, std::memory_order_release);
}

void Records::Reserve(Span<const std::uint32_t> ids) {
  if (ids.empty()) return;
  const std::uint32_t last = *std::max_element(ids.begin(), ids.end());
  Grow(last / kGroupIds + std::size_t{1});
  GroupSlot* const slots = list_.load(std::memory_order_relaxed)->slots();
  for (const std::uint32_t id : ids) {
    GroupSlot& slot = slots[id / kGroupIds];
    Group* group = slot.load(std::memory_order_relaxed);
    if (group == nullptr) {
      group = new (AllocateBlock(memory_, sizeof(Group))) Group{};
      bytes_ += sizeof(Group);
      slot.store(group, std::memory_order_release);
    }
    std::atomic<Word*>& records = group->records[id / 64 % 64];
    if (records.load(std::memory_order_relaxed) != nullptr) continue;
    const std::size_t bytes = 64 * words_ * sizeof(Word);
    auto* const words = static_cast<Word*>(AllocateBlock(memory_, bytes));
    bytes_ += bytes;
    std::uninitialized_value_construct_n(words, 64 * words_);
    records.store(words, std::memory_order_release);
  }
}

void Records::ReserveAs(const Records& other) {
  Grow(other.group_count());
  other.ForEachGroup([&](std::size_t g, const Group& group) {
    for (std::size_t w = 0; w < 64; ++w) {
      if (group.records[w].load(std::memory_order_relaxed) == nullptr) continue;
      const std::uint32_t id = IdOf(g, w, 0);
      Reserve({&id, 1});
    }
  });
}

bool Records::Insert(std::uint32_t id, const float* planes) {
  Word* const record = Find(id);
  const std::uint64_t before = record->load(std::memory_order_relaxed);
  if ((before & kPresent) != 0) return false;
  record->store(before | kIsWritten, std::memory_order_relaxed);
  for (std::size_t w = 1; w < words_; ++w) {
    record[w].store(WordAt(planes + 2 * (w - 1)), std::memory_order_release);
  }
  const std::uint64_t version = (before + kOneWrite) | kPresent;
  record->store((before & ~kVersion) | (version & kVersion),
                std::memory_order_release);
  return true;
}

void Records::Erase(std::uint32_t id) {
  Word* const record = Find(id);
  const std::uint64_t before = record->load(std::memory_order_relaxed);
  const std::uint64_t version = (before + kOneWrite) & ~kPresent;
  record->store((before & ~kVersion) | (version & kVersion),
                std::memory_order_release);
  GroupAt(id / kGroupIds)
      ->marks[id / 64 % 64]
      .fetch_and(~(std::uint64_t{1} << id % 64), std::memory_order_relaxed);
}

void Records::Swap(Records& other) {
  list_.store(other.list_.exchange(list_));
  // Not by exchange(), which is a call of libatomic on riscv64 (gcc 12).
  const bool has_marks = has_marks_;
  has_marks_ = other.has_marks_.load();
  other.has_marks_ = has_marks;
  time_.store(other.time_.exchange(time_));
  std::swap(bytes_, other.bytes_);
  std::swap(counts_, other.counts_);
}

void Records::Clear(ChangedSet set) {
  if (counts_[set] == 0) return;
  counts_[set] = 0;
  ForEachGroup([set](std::size_t, Group& group) {
    std::uint64_t& some = group.some_changed[set];
    for (; some != 0; some &= some - 1) {
      group.changed[set][LowestBit(some)] = 0;
    }
  });
}

}  // namespace halfspace::detail
