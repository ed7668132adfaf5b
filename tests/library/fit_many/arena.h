// Memory for inputs and outputs that is as awkward as a test asks for.
#ifndef HALFSPACE_TESTS_LIBRARY_FIT_MANY_ARENA_H_
#define HALFSPACE_TESTS_LIBRARY_FIT_MANY_ARENA_H_

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#if defined(__unix__)
#include "tests/library/support/guarded_memory.h"
#endif

namespace halfspace::testing {

// Every array starts `offset` elements past a 64-byte boundary, between
// canaries; or, where it is asked for, right at a page that cannot be touched.
class Arena {
 public:
  // By default canaries are NaN, so that an input that is read by mistake shows
  // among others; where it has to be refused, it must not be one.
  static constexpr std::uint32_t kNanCanary = 0x7fc0c5c5u;
  static constexpr std::uint32_t kFiniteCanary = 0x3f8000c5u;

  explicit Arena(std::size_t offset = 0, std::uint32_t canary = kNanCanary)
      : offset_(offset), canary_(canary) {}

#if defined(__unix__)
  explicit Arena(GuardedSide side) : side_(side) {}
#endif

  template <typename T>
  T* New(std::size_t count) {
    static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
#if defined(__unix__)
    if (side_) {
      guarded_.push_back(std::make_unique<GuardedMemory>(count * sizeof(T)));
      return guarded_.back()->Get<T>(count, *side_).data();
    }
#endif
    Block& block = blocks_.emplace_back();
    block.words.assign(kAround * 3 + (offset_ + count) * sizeof(T) / 4,
                       canary_);
    const auto address = reinterpret_cast<std::uintptr_t>(block.words.data());
    block.begin = kAround + (64 - address % 64) / 4 + offset_ * sizeof(T) / 4;
    block.end = block.begin + count * sizeof(T) / 4;
    return reinterpret_cast<T*>(block.words.data() + block.begin);
  }

  // Nothing was written around any array.
  bool Intact() const {
    const auto is_canary = [this](std::uint32_t word) {
      return word == canary_;
    };
    for (const Block& block : blocks_) {
      const auto begin = block.words.begin();
      if (!std::all_of(begin, begin + static_cast<std::ptrdiff_t>(block.begin),
                       is_canary) ||
          !std::all_of(begin + static_cast<std::ptrdiff_t>(block.end),
                       block.words.end(), is_canary)) {
        return false;
      }
    }
    return true;
  }

 private:
  static constexpr std::size_t kAround = 64;  // words; longer than any vector

  struct Block {
    std::vector<std::uint32_t> words;
    std::size_t begin;
    std::size_t end;
  };

  std::size_t offset_ = 0;
  std::uint32_t canary_ = kNanCanary;
  std::list<Block> blocks_;
#if defined(__unix__)
  std::optional<GuardedSide> side_;
  std::vector<std::unique_ptr<GuardedMemory>> guarded_;
#endif
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_FIT_MANY_ARENA_H_
