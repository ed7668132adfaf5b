// The record of each body: its bound, which Move() writes while queries read
// it, and whether it has changed since it was last copied into the tree.
//
// Who reads and writes what:
// - A mover makes the record's version odd, writes the bound, sets the body's
//   mark, and makes the version even. If the mark was not set before, it stamps
//   the record with the time.
// - A thread with the right to change takes marks, and then copies the bounds
//   of these bodies. It waits while a version is odd.
// - A query that cannot have exclusive access is a late query, and takes the
//   time. Bodies with a mark and an earlier stamp are late: their bounds in the
//   tree are older than the query. No mark is taken during it, and a body
//   that gets its mark during the query gets a later stamp. So each body is
//   late or not for all of the query.
//
// The time is a counter that stamps make odd and queries make even, each by
// adding 1 if it is not. It begins at 0 when marks are taken, and from then on
// each body gets one mark at most. So it is at most twice the number of bodies,
// and does not wrap, however many queries run.
//
// No bound is lost. Marks have three levels: a bit for each body, a bit for
// each 64 bodies, and one for all. A mover sets them upwards, a level only
// where it is not set, and they are taken downwards, each by one exchange. All
// of these accesses and those of the time are in one total order. So a mover
// that finds a level set is before the exchange of that level, and its mark is
// taken. And if a query does not see a mark, the mover reads the time later,
// and its stamp is greater. The time is set to 0 before marks are taken, so a
// mark that is not taken gets a stamp of the new time.
#ifndef HALFSPACE_DISPATCH_BROAD_PHASE_RECORDS_H_
#define HALFSPACE_DISPATCH_BROAD_PHASE_RECORDS_H_

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <thread>
#include <type_traits>
#include <utility>

#include "halfspace/detail/bvh.h"
#include "halfspace/mask.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"
#include "kernels/compiler.h"

namespace halfspace::detail {

inline constexpr std::size_t kMostBodyPlanes = 8;  // AaboBroadPhase3

// Calls function(axes) with a constant: loops over the axes have no branches.
template <typename Function>
auto WithAxes(std::size_t axes, const Function& function) {
  switch (axes) {
    case 2:
      return function(std::integral_constant<std::size_t, 2>());
    case 3:
      return function(std::integral_constant<std::size_t, 3>());
    default:
      return function(std::integral_constant<std::size_t, 4>());
  }
}

class Records {
 public:
  Records(const MemoryResource& memory, std::size_t planes)
      : memory_(memory), words_(1 + planes / 2) {}
  Records(const Records&) = delete;
  Records& operator=(const Records&) = delete;
  ~Records();

  std::size_t bytes() const { return bytes_; }
  std::size_t planes() const { return 2 * (words_ - 1); }

  // These can be called at any time.

  bool Has(std::uint32_t id) const {
    const Word* const record = Find(id);
    return record != nullptr &&
           (record->load(std::memory_order_acquire) & kPresent) != 0;
  }
  // Returns the index of the first id that no body has, or ids.size().
  std::size_t FindAbsent(Span<const std::uint32_t> ids) const;
  // Returns whether the body exists, and its bound.
  bool Read(std::uint32_t id, float* planes) const;
  // Writes the bounds of bodies that exist, one after another. A bound that is
  // equal to the one before changes nothing.
  void Move(Span<const std::uint32_t> ids, const float* planes);
  // Whether any body can have a mark.
  bool HasMarks() const { return has_marks_.load(std::memory_order_acquire); }
  // Returns the time of a new query.
  std::uint32_t TimeOfQuery() {
    std::uint32_t time = time_.load(std::memory_order_seq_cst);
    while (time % 2 != 0 && !time_.compare_exchange_weak(
                                time, time + 1, std::memory_order_seq_cst)) {
    }
    return time + time % 2;
  }

  // These need that no other thread takes marks.

  std::size_t CountMarks() const {
    std::size_t count = 0;
    ForEachMarked([&](std::uint32_t) {
      ++count;
      return true;
    });
    return count;
  }

  // `id` is the id of a body.
  bool IsLate(std::uint32_t id, std::uint32_t time_of_query) const {
    const Group& group = *GroupAt(id / kGroupIds);
    if ((group.MarksOf(id / 64 % 64) >> id % 64 & 1) == 0) return false;
    return Settled(*At(id)) >> 32 < time_of_query;
  }
  // Calls visit(id) for each body with a mark, until it returns false.
  template <typename Visit>
  void ForEachMarked(const Visit& visit) const {
    for (std::size_t g = 0; g < group_count(); ++g) {
      const Group* const group = GroupAt(g);
      if (group == nullptr) continue;
      for (std::uint64_t some = group->some.load(std::memory_order_seq_cst);
           some != 0; some &= some - 1) {
        const std::size_t w = LowestBit(some);
        for (std::uint64_t bits = group->MarksOf(w); bits != 0;
             bits &= bits - 1) {
          if (!visit(IdOf(g, w, LowestBit(bits)))) return;
        }
      }
    }
  }

  // These need the right to change, and that no late query runs. Movers may run
  // at the same time.

  // Allocates the list of groups for ids below a limit, or the list that
  // another object has. Reserve() of one id after another would leave several
  // lists. Throws std::bad_alloc.
  void ReserveList(std::size_t id_limit) {
    Grow((id_limit + kGroupIds - 1) / kGroupIds);
  }
  // Allocates the records that another object has.
  void ReserveAs(const Records& other);
  // Allocates the records of these ids. Throws std::bad_alloc.
  void Reserve(Span<const std::uint32_t> ids);
  // Writes a body's bound, after Reserve(). Returns false, and changes nothing,
  // if the body exists.
  bool Insert(std::uint32_t id, const float* planes);
  void Erase(std::uint32_t id);
  // Takes the ids and the sets of changed bodies from another object, after
  // ReserveAs(), with the bounds value_of(id, plane), and without marks.
  template <typename ValueOf>
  void Assign(const Records& other, const ValueOf& value_of);
  // No body may move or be read at the same time.
  void Swap(Records& other);
  // Takes all marks. Returns how many bodies had one.
  std::size_t TakeMarks();
  // Calls visit(id) for each body whose mark the last TakeMarks() took.
  template <typename Visit>
  void ForEachTaken(const Visit& visit) const {
    ForEachGroup([&](std::size_t g, const Group& group) {
      for (std::uint64_t some = group.some_taken; some != 0; some &= some - 1) {
        const std::size_t w = LowestBit(some);
        for (std::uint64_t bits = group.taken[w]; bits != 0; bits &= bits - 1) {
          visit(IdOf(g, w, LowestBit(bits)));
        }
      }
    });
  }

  // Copies the bounds of bodies into a block of a tree. It first finds the
  // records of the bodies, so that they can be prefetched while another block
  // is copied.
  class BlockCopy {
   public:
    // Finds body ids[i] for each set bit i.
    void Find(const Records& records, const std::uint32_t* ids,
              std::uint64_t bits) {
      bits_ = bits;
      for (std::size_t n = 0; bits != 0; bits &= bits - 1, ++n) {
        found_[n] = records.At(ids[LowestBit(bits)]);
        kernels::Prefetch(found_[n]);
      }
    }
    // Writes plane p of a body to to[p * kBlockObjects + bit].
    template <std::size_t kAxes>
    void CopyTo(float* to) const {
      std::size_t n = 0;
      for (std::uint64_t bits = bits_; bits != 0; bits &= bits - 1) {
        Copy(std::make_index_sequence<kAxes>(), *found_[n++],
             to + LowestBit(bits));
      }
    }

   private:
    std::uint64_t bits_ = 0;
    const std::atomic<std::uint64_t>* found_[kBlockObjects];
  };
  // Writes plane p of one body to to[p * kBlockObjects].
  template <std::size_t kAxes>
  void Copy(std::uint32_t id, float* to) const {
    Copy(std::make_index_sequence<kAxes>(), *At(id), to);
  }

  // The bodies whose marks were taken, or for which Add() was called, since
  // Clear(). One set is for UpdatePairs(), and one for Update(), which sorts
  // the more the more bodies are in it. A set depends on moves alone, and not
  // on when marks were taken.
  enum ChangedSet : std::uint8_t { kForPairs, kForOrder };
  void Add(ChangedSet set, std::uint32_t id) {
    Add(set, *GroupAt(id / kGroupIds), id / 64 % 64,
        std::uint64_t{1} << id % 64);
  }
  void SetChanged(std::uint32_t id) {
    Add(kForPairs, id);
    Add(kForOrder, id);
  }
  void Clear(ChangedSet set);
  std::size_t Count(ChangedSet set) const { return counts_[set]; }
  template <typename Visit>
  void ForEachOf(ChangedSet set, const Visit& visit) const {
    ForEachGroup([&](std::size_t g, const Group& group) {
      for (std::uint64_t some = group.some_changed[set]; some != 0;
           some &= some - 1) {
        const std::size_t w = LowestBit(some);
        for (std::uint64_t bits = group.changed[set][w]; bits != 0;
             bits &= bits - 1) {
          visit(IdOf(g, w, LowestBit(bits)));
        }
      }
    });
  }

 private:
  using Word = std::atomic<std::uint64_t>;

  // The first word of a record has the stamp above the version. The lowest bit
  // of the version says that the record is being written. Each other word has
  // two planes.
  static constexpr std::uint64_t kIsWritten = 1;
  static constexpr std::uint64_t kPresent = 2;
  static constexpr std::uint64_t kOneWrite = 4;
  static constexpr std::uint64_t kVersion = 0xFFFFFFFF;

  static constexpr std::size_t kGroupIds = 64 * 64;
  struct Group {
    std::atomic<std::uint64_t> some;  // a bit for 64 bodies, some with marks
    std::atomic<std::uint64_t> marks[64];  // a bit for each body
    std::uint64_t some_taken;
    std::uint64_t taken[64];         // of these
    std::uint64_t some_changed[2];   // by ChangedSet
    std::uint64_t changed[2][64];    // of these
    std::atomic<Word*> records[64];  // of 64 ids each, or null

    std::uint64_t MarksOf(std::size_t w) const {
      return marks[w].load(std::memory_order_seq_cst);
    }
  };
  using GroupSlot = std::atomic<Group*>;
  // A mover may still read an old list of groups, so old lists stay until the
  // end. All of them together are smaller than the newest list.
  struct GroupList {
    GroupList* older;
    std::size_t count;
    GroupSlot* slots() { return reinterpret_cast<GroupSlot*>(this + 1); }
  };

  static std::uint32_t IdOf(std::size_t group, std::size_t word,
                            std::size_t bit) {
    return static_cast<std::uint32_t>(group * kGroupIds + word * 64 + bit);
  }
  std::size_t group_count() const {
    const GroupList* const list = list_.load(std::memory_order_acquire);
    return list == nullptr ? 0 : list->count;
  }
  // `g` is below group_count(). Null if it has no records.
  Group* GroupAt(std::size_t g) const {
    return list_.load(std::memory_order_acquire)
        ->slots()[g]
        .load(std::memory_order_acquire);
  }
  template <typename Visit>
  void ForEachGroup(const Visit& visit) const {
    for (std::size_t g = 0; g < group_count(); ++g) {
      if (Group* const group = GroupAt(g); group != nullptr) visit(g, *group);
    }
  }
  // The record of an id, or null.
  Word* Find(std::uint32_t id) const {
    if (id / kGroupIds >= group_count()) return nullptr;
    Group* const group = GroupAt(id / kGroupIds);
    if (group == nullptr) return nullptr;
    Word* const records =
        group->records[id / 64 % 64].load(std::memory_order_acquire);
    return records == nullptr ? nullptr : records + id % 64 * words_;
  }

  // The record of a body.
  Word* At(std::uint32_t id) const {
    return GroupAt(id / kGroupIds)
               ->records[id / 64 % 64]
               .load(std::memory_order_relaxed) +
           id % 64 * words_;
  }

  // Waits until the record is not being written, and returns its first word.
  static std::uint64_t Settled(const Word& record) {
    std::uint64_t state = record.load(std::memory_order_acquire);
    for (std::size_t tries = 1; (state & kIsWritten) != 0; ++tries) {
      if (tries % 64 == 0) std::this_thread::yield();
      state = record.load(std::memory_order_acquire);
    }
    return state;
  }
  template <std::size_t... kWord>
  static void Copy(std::index_sequence<kWord...>, const Word& record,
                   float* to) {
    std::uint64_t words[sizeof...(kWord)];
    Load(std::index_sequence<kWord...>(), record, words);
    const auto store = [to](std::size_t w, std::uint64_t word) {
      float two[2];
      std::memcpy(two, &word, sizeof(two));
      to[2 * w * kBlockObjects] = two[0];
      to[(2 * w + 1) * kBlockObjects] = two[1];
    };
    (store(kWord, words[kWord]), ...);
  }

  // Reads all planes as they were at one time. Returns the first word. The
  // loads acquire, so that they stay before the second load of the first word.
  // The sanitizers do not support fences.
  template <std::size_t... kWord>
  static std::uint64_t Load(std::index_sequence<kWord...>, const Word& record,
                            std::uint64_t* words) {
    for (;;) {
      std::uint64_t before = record.load(std::memory_order_acquire);
      if ((before & kIsWritten) != 0) [[unlikely]] {
        before = Settled(record);
      }
      ((words[kWord] = (&record)[1 + kWord].load(std::memory_order_acquire)),
       ...);
      if (record.load(std::memory_order_relaxed) == before) return before;
    }
  }
  template <std::size_t... kWord>
  void MoveEach(std::index_sequence<kWord...> each,
                Span<const std::uint32_t> ids, const float* planes);
  std::uint64_t Mark(Group& group, std::size_t w, std::uint64_t bits);
  // The stamp of bodies whose marks have been set.
  std::uint64_t TimeOfStamp() {
    std::uint32_t time = time_.load(std::memory_order_seq_cst);
    if (time % 2 == 0) time = time_.fetch_or(1, std::memory_order_seq_cst);
    return time | 1;
  }
  void Add(ChangedSet set, Group& group, std::size_t w, std::uint64_t bits) {
    counts_[set] += PopCount(bits & ~group.changed[set][w]);
    group.changed[set][w] |= bits;
    group.some_changed[set] |= std::uint64_t{1} << w;
  }
  void Grow(std::size_t groups);

  MemoryResource memory_;
  std::size_t words_;  // of a record
  std::size_t bytes_ = 0;
  std::size_t counts_[2] = {};  // of the bodies in each ChangedSet
  std::atomic<GroupList*> list_{nullptr};
  std::atomic<bool> has_marks_{false};
  std::atomic<std::uint32_t> time_{0};
};

template <typename ValueOf>
void Records::Assign(const Records& other, const ValueOf& value_of) {
  TakeMarks();  // into sets that are replaced
  Clear(kForPairs);
  Clear(kForOrder);
  ForEachGroup([&](std::size_t g, Group& group) {
    const Group* const from =
        g < other.group_count() ? other.GroupAt(g) : nullptr;
    for (std::size_t w = 0; w < 64; ++w) {
      Word* const to = group.records[w].load(std::memory_order_relaxed);
      const Word* const its =
          from == nullptr ? nullptr
                          : from->records[w].load(std::memory_order_relaxed);
      if (to == nullptr) continue;
      WithAxes(words_ - 1, [&](auto axes) {
        constexpr std::size_t kWords = 1 + axes;
        for (std::size_t i = 0; i < 64; ++i) {
          Word* const record = to + i * kWords;
          const bool is_body =
              its != nullptr &&
              (its[i * kWords].load(std::memory_order_relaxed) & kPresent) != 0;
          record->store(is_body ? kPresent : 0, std::memory_order_relaxed);
          for (std::size_t a = 0; is_body && a < axes; ++a) {
            const float two[2] = {value_of(IdOf(g, w, i), 2 * a),
                                  value_of(IdOf(g, w, i), 2 * a + 1)};
            std::uint64_t word;
            std::memcpy(&word, two, sizeof(word));
            record[1 + a].store(word, std::memory_order_relaxed);
          }
        }
      });
    }
  });
  for (const ChangedSet set : {kForPairs, kForOrder}) {
    other.ForEachOf(set, [&](std::uint32_t id) { Add(set, id); });
  }
}

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BROAD_PHASE_RECORDS_H_
