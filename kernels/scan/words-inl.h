// Which words, and which groups of objects, have a survivor.
#if defined(HALFSPACE_KERNELS_SCAN_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
#undef HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "halfspace/detail/word-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Plain code has none.
inline constexpr bool kHasVectors =
    HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128;

// Bit w of the result says whether words[w] is nonzero; at most 64 words. There
// is no branch, because which words are nonzero cannot be predicted.
HWY_INLINE uint64_t NonzeroWords(const uint64_t* words, size_t count) {
  uint64_t nonzero = 0;
  size_t w = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::CappedTag<uint64_t, 8> d;
  const size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  // Four at a time: the shifts within are constants.
  constexpr size_t kUnroll = 4;
  for (; w + kUnroll * lanes <= count; w += kUnroll * lanes) {
    uint64_t bits = 0;
    for (size_t u = 0; u < kUnroll; ++u) {
      const auto vector = hn::LoadU(d, words + w + u * lanes);
      bits |= LaneBits(d, hn::Ne(vector, zero)) << (u * lanes);
    }
    nonzero |= bits << w;
  }
  for (; w + lanes <= count; w += lanes) {
    nonzero |= LaneBits(d, hn::Ne(hn::LoadU(d, words + w), zero)) << w;
  }
#endif
  for (; w < count; ++w) nonzero |= uint64_t{words[w] != 0} << w;
  return nonzero;
}

// Sets bit g of `groups` for each group of kGroup objects, of at most 64 words,
// that has a survivor, and clears the other bits. Returns how many have one.
template <size_t kGroup>
HWY_INLINE size_t NonzeroGroups(const uint64_t* words, size_t count,
                                uint64_t* groups) {
  size_t found = 0;
  for (size_t begin = 0; begin < count; begin += kGroup) {
    uint64_t bits = 0;
    const size_t left = HWY_MIN(kGroup, count - begin);
    if constexpr (kGroup == kWordObjects) {
      bits = NonzeroWords(words, left);
    } else {
      static_assert(kGroup == 16 || kGroup == 8);
      constexpr size_t kInWord = kWordObjects / kGroup;
      size_t w = 0;
#if HWY_TARGET != HWY_SCALAR
      // At most 32 groups, whose bits have a type of their own.
      const hn::CappedTag<uint64_t, 4> d;
      using Group = std::conditional_t<kGroup == 8, uint8_t, uint16_t>;
      const hn::Repartition<Group, decltype(d)> of_group;
      const size_t lanes = hn::Lanes(d);
      for (; w + lanes <= left; w += lanes) {
        const auto vector =
            hn::BitCast(of_group, hn::LoadU(d, words + begin + w));
        bits |= LaneBits(of_group, hn::Ne(vector, hn::Zero(of_group)))
                << (kInWord * w);
      }
#endif
      for (; w < left; ++w) {
        for (size_t g = 0; g < kInWord; ++g) {
          const uint64_t group = words[begin + w] >> (kGroup * g);
          const bool is_left = (group & kLowBits<kGroup>) != 0;
          bits |= uint64_t{is_left} << (kInWord * w + g);
        }
      }
    }
    groups[begin / kGroup] = bits;
    found += hwy::PopCount(bits);
  }
  return found;
}

// kept(i) is the bits of the group that begins at object i. Clears the other
// bits in the row, for each group of `words` words that has a bit in `groups`.
template <size_t kGroup, class Kept>
HWY_INLINE void VisitGroups(const uint64_t* groups, size_t words,
                            uint64_t* HWY_RESTRICT row, const Kept& kept) {
  for (size_t w = 0; w < words; w += kGroup) {
    for (uint64_t bits = groups[w / kGroup]; bits != 0; bits &= bits - 1) {
      const size_t i =
          w * kWordObjects + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits) * kGroup;
      const uint64_t rejected = kept(i) ^ kLowBits<kGroup>;
      row[i / kWordObjects] &= ~(rejected << i % kWordObjects);
    }
  }
}

// NonzeroWords() as a function (words.cc).
uint64_t FindNonzeroWords(const uint64_t* words, size_t count);

// The number of bits in those of at most 64 words that `nonzero` names.
// Compiled per target, because the baseline of x86 has no popcnt.
size_t CountBits(const uint64_t* words, uint64_t nonzero);

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
