// Which ids of a BVH objects have, and the least that is free.
#ifndef HALFSPACE_DISPATCH_BVH_USED_IDS_H_
#define HALFSPACE_DISPATCH_BVH_USED_IDS_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "kernels/bvh/levels.h"

namespace halfspace::detail {

// A set of ids below a limit, in memory of the caller. It has a bit for each
// id. The level above has a bit for each of these words, which says that the
// word is full, and so on up to one word. So each call reads one word of each
// level.
class UsedIds {
 public:
  // The number of words, which is 0 for a limit of 0.
  static constexpr std::size_t WordsFor(std::size_t limit) {
    std::size_t all = 0;
    while (limit > 0) {
      const std::size_t words = WordsOf(limit);
      all += words;
      limit = words == 1 ? 0 : words;
    }
    return all;
  }

  UsedIds(std::uint64_t* words, std::size_t limit)
      : words_(words), limit_(limit) {}

  bool Has(std::size_t id) const { return (words_[id / 64] & BitOf(id)) != 0; }

  void Add(std::size_t id) {
    std::uint64_t* level = words_;
    for (std::size_t limit = limit_;; limit = WordsOf(limit), id /= 64) {
      std::uint64_t& word = level[id / 64];
      word |= BitOf(id);
      if (~word != 0 || limit <= 64) return;
      level += WordsOf(limit);
    }
  }

  void Remove(std::size_t id) {
    std::uint64_t* level = words_;
    for (std::size_t limit = limit_;; limit = WordsOf(limit), id /= 64) {
      std::uint64_t& word = level[id / 64];
      const bool was_full = ~word == 0;
      word &= ~BitOf(id);
      if (!was_full || limit <= 64) return;
      level += WordsOf(limit);
    }
  }

  // The least id below the limit that is not in the set. There must be one.
  std::size_t Least() const { return LeastOf(words_, limit_); }

  void Clear() {
    std::memset(words_, 0, WordsFor(limit_) * sizeof(std::uint64_t));
  }

  // Copies a set with a lower limit into this one, which must be empty.
  void AddAll(const UsedIds& other) {
    const std::size_t words = WordsOf(other.limit_);
    std::memcpy(words_, other.words_, words * sizeof(std::uint64_t));
    std::uint64_t* level = words_;
    for (std::size_t limit = limit_; limit > 64; limit = WordsOf(limit)) {
      std::uint64_t* const above = level + WordsOf(limit);
      for (std::size_t w = 0; w < WordsOf(limit); ++w) {
        if (~level[w] == 0) above[w / 64] |= BitOf(w);
      }
      level = above;
    }
  }

  // Whether the set has `size` ids, and the levels above are consistent with
  // them.
  bool IsRight(std::size_t size) const {
    const std::uint64_t* level = words_;
    for (std::size_t w = 0; w < WordsOf(limit_); ++w) {
      size -= static_cast<std::size_t>(std::popcount(level[w]));
    }
    for (std::size_t limit = limit_; limit > 64; limit = WordsOf(limit)) {
      const std::uint64_t* const above = level + WordsOf(limit);
      for (std::size_t w = 0; w < (WordsOf(limit) + 63) / 64 * 64; ++w) {
        const bool is_full = w < WordsOf(limit) && ~level[w] == 0;
        if (((above[w / 64] & BitOf(w)) != 0) != is_full) return false;
      }
      level = above;
    }
    return size == 0;
  }

 private:
  static constexpr std::size_t WordsOf(std::size_t bits) {
    return (bits + 63) / 64;
  }
  static std::size_t LeastOf(const std::uint64_t* level, std::size_t limit) {
    const std::size_t w =
        limit <= 64 ? 0 : LeastOf(level + WordsOf(limit), WordsOf(limit));
    return w * 64 + static_cast<std::size_t>(std::countr_one(level[w]));
  }

  std::uint64_t* words_;
  std::size_t limit_;
};

}  // namespace halfspace::detail

#endif  // HALFSPACE_DISPATCH_BVH_USED_IDS_H_
