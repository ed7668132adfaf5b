#include "dispatch/broad_phase/records.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <new>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "kernels/compiler.h"

namespace halfspace::detail {
namespace {

// The number of bodies that are moved between two fences.
constexpr std::size_t kSome = 64;

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

template <typename EightAt>
std::uint64_t Records::Group::MarksBy(std::size_t w, const EightAt& eight_at) {
  // Moves byte i, 0 or 1, to bit 56 + i.
  constexpr std::uint64_t kGather = std::endian::native == std::endian::little
                                        ? 0x0102040810204080
                                        : 0x8040201008040201;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    bits |= eight_at(8 * w + i) * kGather >> 56 << 8 * i;
  }
  return bits;
}

std::uint64_t Records::Group::MarksOf(std::size_t w) const {
  return MarksBy(w, [this](std::size_t i) {
    return reinterpret_cast<const Word*>(marks)[i].load(
        std::memory_order_acquire);
  });
}

std::uint64_t Records::Group::TakeMarksOf(std::size_t w) {
  return MarksBy(w, [this](std::size_t i) {
    Word& eight = reinterpret_cast<Word*>(marks)[i];
    return eight.load(std::memory_order_seq_cst) == 0
               ? 0
               : eight.exchange(0, std::memory_order_seq_cst);
  });
}

// Sets a mark while marks are being taken. Repeats that until the mark will be
// found.
HALFSPACE_NOINLINE void Records::MarkAgain(std::uint32_t id) {
  Group& group = *GroupAt(id / kGroupIds);
  const std::uint64_t bit = std::uint64_t{1} << id / 64 % 64;
  const auto is_marked = [&] {
    return group.marks[id % kGroupIds].load(std::memory_order_relaxed) != 0 &&
           (group.some.load(std::memory_order_relaxed) & bit) != 0 &&
           has_marks_.load(std::memory_order_relaxed);
  };
  for (; !is_marked(); Fence()) {
    group.marks[id % kGroupIds].store(1, std::memory_order_relaxed);
    group.some.fetch_or(bit, std::memory_order_relaxed);
    has_marks_.store(true, std::memory_order_relaxed);
  }
}

// The words of a record are a parameter pack, because a loop over an array
// takes twice the time.
template <std::size_t... kWord>
void Records::MoveSome(std::index_sequence<kWord...>,
                       Span<const std::uint32_t> ids, const float* planes) {
  struct Written {
    Word* record;
    std::uint64_t state;  // when all is written
    std::uint32_t id;
    bool is_new;  // to those with marks
  } written[kSome];
  std::size_t count = 0;
  const std::uint64_t takes = takes_.load(std::memory_order_acquire);
  const bool is_taking = takes % 2 != 0;
  std::uint32_t number = ~std::uint32_t{0};  // of 64 ids
  Group* group = nullptr;
  Word* records = nullptr;
  for (const std::uint32_t id : ids) {
    if (id / 64 != number) {
      number = id / 64;
      group = GroupAt(id / kGroupIds);
      records = group->records[number % 64].load(std::memory_order_relaxed);
    }
    Word* const record = records + id % 64 * (1 + sizeof...(kWord));
    const auto move = [&](auto... words) {
      const std::uint64_t different =
          ((record[1 + kWord].load(std::memory_order_relaxed) ^ words) | ...);
      if (different == 0) return;
      const std::uint64_t before = record->load(std::memory_order_relaxed);
      if ((before & kIsWritten) == 0) {  // else a second time in the list
        record->store(before | kIsWritten, std::memory_order_relaxed);
        const std::uint64_t version = (before + kOneWrite) & kVersion;
        std::atomic<std::uint8_t>& mark = group->marks[id % kGroupIds];
        const bool is_new =
            (is_taking ? mark.exchange(1, std::memory_order_acq_rel)
                       : mark.load(std::memory_order_relaxed)) == 0;
        written[count++] = {record, (before & ~kVersion) | version, id, is_new};
        // This store and the next ones release, so that they stay after the
        // first store.
        mark.store(1, std::memory_order_release);
      }
      (record[1 + kWord].store(words, std::memory_order_release), ...);
      const std::uint64_t bit = std::uint64_t{1} << number % 64;
      if ((group->some.load(std::memory_order_relaxed) & bit) == 0) {
        group->some.fetch_or(bit, std::memory_order_relaxed);
      }
    };
    move(WordAt(planes + 2 * kWord)...);
    planes += 2 * sizeof...(kWord);
  }
  if (count == 0) return;
  if (!has_marks_.load(std::memory_order_relaxed)) {
    has_marks_.store(true, std::memory_order_relaxed);
  }
  Fence();
  if (takes_.load(std::memory_order_relaxed) != takes || is_taking)
      [[unlikely]] {
    for (std::size_t i = 0; i < count; ++i) {
      MarkAgain(written[i].id);
      // Marks that were set before have been taken. If marks were already being
      // taken at the beginning, the exchange has returned whether the mark was
      // set.
      if (!is_taking) written[i].is_new = true;
    }
  }
  const std::uint64_t stamp =
      std::uint64_t{queries_.load(std::memory_order_relaxed)} << 32;
  for (std::size_t i = 0; i < count; ++i) {
    const Written& its = written[i];
    its.record->store(its.is_new ? (its.state & kVersion) | stamp : its.state,
                      std::memory_order_release);
  }
}

void Records::Move(Span<const std::uint32_t> ids, const float* planes) {
  for (std::size_t i = 0; i < ids.size(); i += kSome) {
    const Span<const std::uint32_t> some(ids.data() + i,
                                         std::min(kSome, ids.size() - i));
    const float* const of_some = planes + i * this->planes();
    WithAxes(words_ - 1, [&](auto axes) {
      MoveSome(std::make_index_sequence<axes>(), some, of_some);
    });
  }
}

// A mover that runs at the same time sees that takes_ has changed, and reads
// its mark again after a fence. Either the mark is taken here later, or the
// mover sets it again. (Only a thread with exclusive access writes takes_, so
// plain stores will do.) So each eight marks are taken by one exchange, after
// the exchange of `some` in the single total order, and has_marks_ is cleared
// before the fence.
std::size_t Records::TakeMarks() {
  std::size_t count = 0;
  const std::uint64_t takes = takes_.load(std::memory_order_relaxed);
  takes_.store(takes + 1, std::memory_order_relaxed);
  has_marks_.store(false, std::memory_order_relaxed);
  Fence();
  ForEachGroup([&](std::size_t, Group& group) {
    group.some_taken = group.some.load(std::memory_order_relaxed);
    if (group.some_taken == 0) return;
    group.some_taken = group.some.exchange(0, std::memory_order_seq_cst);
    for (std::uint64_t some = group.some_taken; some != 0; some &= some - 1) {
      const std::size_t w = LowestBit(some);
      group.taken[w] = group.TakeMarksOf(w);
      Add(kForPairs, group, w, group.taken[w]);
      Add(kForOrder, group, w, group.taken[w]);
      count += PopCount(group.taken[w]);
    }
  });
  Fence();
  takes_.store(takes + 2, std::memory_order_release);
  return count;
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
      ->marks[id % kGroupIds]
      .store(0, std::memory_order_relaxed);
}

void Records::Swap(Records& other) {
  list_.store(other.list_.exchange(list_));
  has_marks_.store(other.has_marks_.exchange(has_marks_));
  std::swap(bytes_, other.bytes_);
  std::swap(counts_, other.counts_);
}

void Records::Clear(ChangedSet set) {
  if (counts_[set] == 0) return;
  counts_[set] = 0;
  ForEachGroup([set](std::size_t, Group& group) {
    std::fill_n(group.changed[set], 64, 0);
  });
}

}  // namespace halfspace::detail
