// Masks: one bit for each object, 64 objects in a word.
//
//   std::vector<std::uint64_t> mask(halfspace::MaskWords(world.size()));
//   halfspace::SurvivorMask(world, query, mask);  // reject.h, or kernels.h
//   for (std::size_t i : halfspace::SetBits(mask)) Collide(i);
//
// Object i is bit i % 64 of word i / 64. Masks are those of reject.h,
// reject_many.h and kernels.h, and what a program makes of them, for example
// the OR of two.
//
// Thread safety: pure functions, and iterators that are plain values.
#ifndef HALFSPACE_MASK_H_
#define HALFSPACE_MASK_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/span.h"

namespace halfspace {

// The number of words in a mask of `objects` objects.
constexpr std::size_t MaskWords(std::size_t objects) {
  return objects / 64 + (objects % 64 != 0 ? 1 : 0);
}

namespace detail {

// C++17 has no <bit>.
inline std::size_t PopCount(std::uint64_t word) {
  // Sums of pairs, of fours, of bytes, and of all bytes in the highest one.
  word -= word >> 1 & 0x5555555555555555u;
  word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
  word = (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0Fu;
  return static_cast<std::size_t>(word * 0x0101010101010101u >> 56);
}

// `word` is not 0.
inline std::size_t LowestBit(std::uint64_t word) {
#if defined(__GNUC__) || defined(__clang__)
  return static_cast<std::size_t>(__builtin_ctzll(word));
#else
  return PopCount((word & (~word + 1)) - 1);
#endif
}

}  // namespace detail

// The numbers of the bits that are 1, in ascending order, for a range-based for
// loop. The words must outlive the loop and must not change during it.
//
// Cost: about 1 ns for each bit, and less for each word that is 0.
class SetBits {
 public:
  explicit SetBits(Span<const std::uint64_t> mask) : mask_(mask) {}

  struct End {};

  class Iterator {
   public:
    explicit Iterator(Span<const std::uint64_t> mask)
        : mask_(mask), left_(mask.empty() ? 0 : mask[0]) {
      SkipZeros();
    }
    std::size_t operator*() const {
      return 64 * word_ + detail::LowestBit(left_);
    }
    Iterator& operator++() {
      left_ &= left_ - 1;
      SkipZeros();
      return *this;
    }
    bool operator!=(End) const { return left_ != 0; }

   private:
    void SkipZeros() {
      while (left_ == 0 && ++word_ < mask_.size()) left_ = mask_[word_];
    }

    Span<const std::uint64_t> mask_;
    std::size_t word_ = 0;
    std::uint64_t left_;  // of this word
  };

  Iterator begin() const { return Iterator(mask_); }
  End end() const { return {}; }

 private:
  Span<const std::uint64_t> mask_;
};

// The number of bits that are 1.
inline std::size_t CountBits(Span<const std::uint64_t> mask) {
  std::size_t count = 0;
  for (std::uint64_t word : mask) count += detail::PopCount(word);
  return count;
}

}  // namespace halfspace

#endif  // HALFSPACE_MASK_H_
