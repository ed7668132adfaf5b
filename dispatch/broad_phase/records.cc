#include "dispatch/broad_phase/records.h"

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "halfspace/detail/plane_arrays.h"

namespace halfspace::detail {

Records::~Records() {
  GroupList* list = list_.load();
  for (std::size_t g = 0; g < group_count(); ++g) {
    Group* const group = GroupAt(g);
    if (group == nullptr) continue;
    for (const std::atomic<Word*>& records : group->records) {
      if (records.load() == nullptr) continue;
      FreeBlock(memory_, records.load(), 64 * words_ * sizeof(Word));
    }
    FreeBlock(memory_, group, sizeof(Group));
  }
  while (list != nullptr) {
    GroupList* const older = list->older;
    FreeBlock(memory_, list,
              sizeof(GroupList) + list->count * sizeof(GroupSlot));
    list = older;
  }
}

bool Records::Read(std::uint32_t id, float* planes) const {
  const Word* const record = Find(id);
  if (record == nullptr) return false;
  std::uint64_t words[kMostBodyPlanes / 2];
  const std::uint64_t state = words_ == 3   ? Load<2>(*record, words)
                              : words_ == 4 ? Load<3>(*record, words)
                                            : Load<4>(*record, words);
  std::memcpy(planes, words, (words_ - 1) * sizeof(std::uint64_t));
  return (state & kPresent) != 0;
}

// Marks are set first in the word of 64 bodies, then in that of its group, then
// for all, and TakeMarks() clears them in the opposite order. A mark that
// TakeMarks() does not see is not hidden by what it clears.
void Records::Mark(std::uint32_t first, std::uint64_t bits,
                   std::uint64_t& old) {
  Group& group = *GroupAt(first / kGroupIds);
  const std::size_t w = first / 64 % 64;
  old = group.marks[w].fetch_or(bits, std::memory_order_seq_cst);
  const std::uint64_t bit = std::uint64_t{1} << w;
  if ((group.some.load(std::memory_order_seq_cst) & bit) == 0) {
    group.some.fetch_or(bit, std::memory_order_seq_cst);
  }
  if (!has_marks_.load(std::memory_order_seq_cst)) {
    has_marks_.store(true, std::memory_order_seq_cst);
  }
}

template <std::size_t kWords>
void Records::MoveSome(Span<const std::uint32_t> ids, const float* planes) {
  constexpr std::size_t kSome = 64;
  struct Written {
    Word* record;
    std::uint64_t state;  // when all is written
    std::uint32_t id;
  } written[kSome];
  std::size_t count = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Word* const record = Find(ids[i]);
    std::uint64_t words[kWords];
    std::memcpy(words, planes + 2 * kWords * i, sizeof(words));
    std::uint64_t different = 0;
    for (std::size_t w = 0; w < kWords; ++w) {
      different |= record[1 + w].load(std::memory_order_relaxed) ^ words[w];
    }
    if (different == 0) continue;
    const std::uint64_t before = record->load(std::memory_order_relaxed);
    record->store(before | kIsWritten, std::memory_order_relaxed);
    // They release, so that they stay behind the first store.
    for (std::size_t w = 0; w < kWords; ++w) {
      record[1 + w].store(words[w], std::memory_order_release);
    }
    const std::uint64_t version = (before + kOneWrite) & ~kIsWritten;
    written[count++] = {record, (before & ~kVersion) | (version & kVersion),
                        ids[i]};
  }
  // An atomic change of a word takes as long as all else, so bodies of one word
  // that follow each other share it.
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < count; begin = next) {
    const std::uint32_t first = written[begin].id & ~std::uint32_t{63};
    std::uint64_t bits = 0;
    for (next = begin; next < count && written[next].id - first < 64; ++next) {
      bits |= std::uint64_t{1} << written[next].id % 64;
    }
    std::uint64_t old = 0;
    Mark(first, bits, old);
    const std::uint64_t stamp = queries_.load(std::memory_order_seq_cst);
    for (std::size_t i = begin; i < next; ++i) {
      std::uint64_t state = written[i].state;
      if ((old >> written[i].id % 64 & 1) == 0) {
        state = (state & kVersion) | stamp << 32;
      }
      written[i].record->store(state, std::memory_order_release);
    }
  }
}

void Records::Move(Span<const std::uint32_t> ids, const float* planes) {
  constexpr std::size_t kSome = 64;
  for (std::size_t i = 0; i < ids.size(); i += kSome) {
    const Span<const std::uint32_t> some(ids.data() + i,
                                         std::min(kSome, ids.size() - i));
    const float* const of_some = planes + i * this->planes();
    if (words_ == 3) {
      MoveSome<2>(some, of_some);
    } else if (words_ == 4) {
      MoveSome<3>(some, of_some);
    } else {
      MoveSome<4>(some, of_some);
    }
  }
}

void Records::Grow(std::size_t groups) {
  GroupList* const old = list_.load(std::memory_order_relaxed);
  if (old != nullptr && old->count >= groups) return;
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

bool Records::Insert(std::uint32_t id, const float* planes) {
  Word* const record = Find(id);
  const std::uint64_t before = record->load(std::memory_order_relaxed);
  if ((before & kPresent) != 0) return false;
  record->store(before | kIsWritten, std::memory_order_relaxed);
  for (std::size_t w = 1; w < words_; ++w) {
    std::uint64_t word = 0;
    std::memcpy(&word, planes + 2 * (w - 1), sizeof(word));
    record[w].store(word, std::memory_order_release);
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
      .fetch_and(~(std::uint64_t{1} << id % 64), std::memory_order_seq_cst);
}

void Records::Swap(Records& other) {
  list_.store(other.list_.exchange(list_));
  has_marks_.store(other.has_marks_.exchange(has_marks_));
  std::swap(bytes_, other.bytes_);
}

void Records::ClearChanged() {
  for (std::size_t g = 0; g < group_count(); ++g) {
    if (Group* const group = GroupAt(g); group != nullptr) {
      std::fill_n(group->changed, 64, 0);
    }
  }
}

}  // namespace halfspace::detail
