// Internal. What PairEvents (pair_events.h) and BroadPhase own, after the types
// are gone. Not part of the interface.
#ifndef HALFSPACE_DETAIL_PAIR_EVENTS_H_
#define HALFSPACE_DETAIL_PAIR_EVENTS_H_

#include <cstddef>
#include <cstdint>
#include <utility>

#include "halfspace/bvh_pairs.h"
#include "halfspace/detail/bvh.h"
#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"

namespace halfspace {

struct PairEventOptions;

namespace detail {

// Pairs in memory of a resource.
class HALFSPACE_API PairList {
 public:
  explicit PairList(const MemoryResource& memory) : memory_(memory) {}
  PairList(const PairList& other, const MemoryResource& memory);
  PairList(const PairList& other) : PairList(other, MemoryResource()) {}
  PairList(PairList&& other) noexcept : PairList(other.memory_) { Swap(other); }
  // Into the memory that is there, if it is enough.
  PairList& operator=(const PairList& other) {
    if (this == &other) return *this;
    Reserve(other.size_);
    size_ = 0;
    Append(other.span());
    return *this;
  }
  PairList& operator=(PairList&& other) { return AssignMove(*this, other); }
  ~PairList();
  friend void swap(PairList& a, PairList& b) noexcept { a.Swap(b); }

  const MemoryResource& memory() const { return memory_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return capacity_ * sizeof(IdPair); }
  IdPair* data() const { return data_; }
  IdPair* begin() const { return data_; }
  IdPair* end() const { return data_ + size_; }
  Span<const IdPair> span() const { return {data_, size_}; }

  // Room for so many, and, if there was less, for half as many again as before.
  void Reserve(std::size_t count) {
    if (count > capacity_) Grow(count);
  }
  // There must be room, and the pairs must have been written.
  void SetSize(std::size_t size) { size_ = size; }
  // There must be room.
  void Add(IdPair pair) { data_[size_++] = pair; }
  void Append(Span<const IdPair> pairs) {
    Reserve(size_ + pairs.size());
    for (const IdPair& pair : pairs) Add(pair);
  }

 private:
  void Grow(std::size_t count);
  void Swap(PairList& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

  MemoryResource memory_;
  IdPair* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

// Which of some pairs that overlap are kept, moved to their front. Returns how
// many. The lesser id of each is first. Parts of a search that run on several
// threads call it at the same time.
struct PairListFilter {
  std::size_t (*keep)(void* context, Span<IdPair> pairs) = nullptr;
  void* context = nullptr;
};

// The pairs of the last Update(), and what it changed.
class HALFSPACE_API PairEventsCore {
 public:
  explicit PairEventsCore(const MemoryResource& memory)
      : pairs_(memory), began_(memory), ended_(memory) {}
  PairEventsCore(const PairEventsCore& other, const MemoryResource& memory)
      : pairs_(other.pairs_, memory),
        began_(other.began_, memory),
        ended_(other.ended_, memory),
        id_limit_(other.id_limit_) {}
  PairEventsCore(const PairEventsCore& other)
      : PairEventsCore(other, MemoryResource()) {}
  PairEventsCore(PairEventsCore&& other) noexcept
      : PairEventsCore(other.memory()) {
    swap(*this, other);
  }
  PairEventsCore& operator=(const PairEventsCore& other) {
    Reserve(other);
    pairs_ = other.pairs_;
    began_ = other.began_;
    ended_ = other.ended_;
    id_limit_ = other.id_limit_;
    return *this;
  }
  PairEventsCore& operator=(PairEventsCore&& other) {
    return AssignMove(*this, other);
  }
  ~PairEventsCore() = default;
  friend void swap(PairEventsCore& a, PairEventsCore& b) noexcept {
    swap(a.pairs_, b.pairs_);
    swap(a.began_, b.began_);
    swap(a.ended_, b.ended_);
    std::swap(a.id_limit_, b.id_limit_);
  }

  const MemoryResource& memory() const { return pairs_.memory(); }
  std::size_t bytes() const {
    return pairs_.bytes() + began_.bytes() + ended_.bytes();
  }
  Span<const IdPair> pairs() const { return pairs_.span(); }
  Span<const IdPair> began() const { return began_.span(); }
  Span<const IdPair> ended() const { return ended_.span(); }

  // The pairs of a tree now. With `sources.ids`, the pairs of all other objects
  // are those of the last call. These ids may be no objects' any more, and may
  // be in the list more than once.
  void Update(const PairSources& sources, const PairEventOptions& options,
              const PairListFilter& filter = {});
  void Clear();
  void Load(Span<const IdPair> pairs);
  // An assignment of `other` then does not fail.
  void Reserve(const PairEventsCore& other) {
    pairs_.Reserve(other.pairs_.size());
    began_.Reserve(other.began_.size());
    ended_.Reserve(other.ended_.size());
  }

 private:
  void UpdateAll(const PairSources& sources, const PairEventOptions& options,
                 const PairListFilter& filter);
  void UpdateSome(const PairSources& sources, const PairEventOptions& options,
                  const PairListFilter& filter);

  PairList pairs_;
  PairList began_;
  PairList ended_;
  std::size_t id_limit_ = 0;  // of the pairs
};

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_PAIR_EVENTS_H_
