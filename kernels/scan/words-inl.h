// Which words, and which groups of objects, have a survivor.
#if defined(HALFSPACE_KERNELS_SCAN_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
#undef HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>
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

// A tile is 4096 objects: one word has a bit for each of its words, and what a
// stage keeps for the next one stays in L1. A group is the objects of a tile
// that a stage tests or skips together.
inline constexpr size_t kTileWords = 64;
#if HWY_HAVE_SCALABLE
// A group must hold a whole vector, whose length is not known here.
inline constexpr size_t kGroupObjects = kWordObjects;
#else
inline constexpr size_t kGroupObjects = 16;
#endif
inline constexpr size_t kWordGroups = kWordObjects / kGroupObjects;

template <size_t kGroup>
using GroupBits =
    std::conditional_t<kGroup == 64, uint64_t,
                       std::conditional_t<kGroup == 16, uint16_t, uint8_t>>;

// ANDs bits to those of a group of the row. A load and a store of these bits
// alone: a change of the whole word would wait for the change of the group
// before, and a scan by axis took up to 1.5 times as long.
template <size_t kGroup>
HWY_INLINE GroupBits<kGroup> AndGroup(uint64_t* row, size_t group,
                                      uint64_t bits) {
  GroupBits<kGroup> left;
  if constexpr (!kIsLittleEndian) group ^= kWordObjects / kGroup - 1;
  char* const at = reinterpret_cast<char*>(row) + group * sizeof(left);
  std::memcpy(&left, at, sizeof(left));
  left &= static_cast<GroupBits<kGroup>>(bits);
  std::memcpy(at, &left, sizeof(left));
  return left;
}

// The groups of kGroup objects, of at most a tile, that have a survivor. They
// are found by vectors, because which groups survive cannot be predicted: a
// branch for each took three times as long as a flat scan.
template <size_t kGroup>
class Groups {
  static_assert(kGroup == 8 || kGroup == 16 || kGroup == kWordObjects);

 public:
  // Finds them in some words, and returns their number.
  HWY_INLINE size_t Find(const uint64_t* row, size_t words);

  // ANDs kept(i), the bits of the group that begins at object i, to the row of
  // each of them. Groups without a survivor are dropped, unless it is the last
  // visit. Returns the number of the others.
  template <class Kept>
  HWY_INLINE size_t Visit(uint64_t* HWY_RESTRICT row, bool is_last,
                          const Kept& kept);

 private:
  static constexpr size_t kInWord = kWordObjects / kGroup;
  static constexpr size_t kMost = kTileWords * kInWord;

#if HALFSPACE_MASKED_COMPARES
  // Keeps the numbers ids(0), ids(16), ... whose groups have a bit.
  template <class Ids>
  HWY_INLINE size_t Keep(const GroupBits<kGroup>* bits, const Ids& ids) {
    size_t kept = 0;
    for (size_t j = 0; j < count_; j += kLanes) {
      const auto in = static_cast<__mmask16>(
          count_ - j < kLanes ? (1u << (count_ - j)) - 1 : 0xffff);
      __mmask16 left;
      if constexpr (kGroup == 8) {
        const __m128i some = _mm_maskz_loadu_epi8(in, bits + j);
        left = _mm_test_epi8_mask(some, some);
      } else {
        const __m256i some = _mm256_maskz_loadu_epi16(in, bits + j);
        left = _mm256_test_epi16_mask(some, some);
      }
      const __m512i these = _mm512_maskz_compress_epi32(left, ids(j));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(ids_ + kept),
                          _mm512_cvtepi32_epi16(these));
      kept += hwy::PopCount(left);
    }
    return count_ = kept;
  }

  // A list of their numbers. Of 16 bits, because a call takes little stack.
  static constexpr size_t kLanes = 16;
  uint16_t ids_[kMost + kLanes];
  GroupBits<kGroup> bits_[kMost];
  size_t count_;
#else
  // One bit for each group. A list of their numbers took 1.1 to 1.5 times as
  // long with SSE4 and AVX2.
  uint64_t bits_[kMost / 64];
  size_t words_;
#endif
};

#if HALFSPACE_MASKED_COMPARES

template <size_t kGroup>
HWY_INLINE size_t Groups<kGroup>::Find(const uint64_t* row, size_t words) {
  count_ = words * kInWord;
  __m512i ids =
      _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  return Keep(reinterpret_cast<const GroupBits<kGroup>*>(row),
              [&](size_t) HWY_ATTR {
                const __m512i these = ids;
                ids = _mm512_add_epi32(ids, _mm512_set1_epi32(kLanes));
                return these;
              });
}

template <size_t kGroup>
template <class Kept>
HWY_INLINE size_t Groups<kGroup>::Visit(uint64_t* HWY_RESTRICT row,
                                        bool is_last, const Kept& kept) {
  for (size_t j = 0; j < count_; ++j) {
    bits_[j] = AndGroup<kGroup>(row, ids_[j], kept(ids_[j] * kGroup));
  }
  if (is_last) return 0;
  return Keep(bits_, [&](size_t j) HWY_ATTR {
    return _mm512_cvtepu16_epi32(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(ids_ + j)));
  });
}

#else

template <size_t kGroup>
HWY_INLINE size_t Groups<kGroup>::Find(const uint64_t* row, size_t words) {
  words_ = words;
  size_t found = 0;
  for (size_t begin = 0; begin < words; begin += kGroup) {
    uint64_t bits = 0;
    const size_t left = HWY_MIN(kGroup, words - begin);
    if constexpr (kGroup == kWordObjects) {
      bits = NonzeroWords(row, left);
    } else {
      size_t w = 0;
#if HWY_TARGET != HWY_SCALAR
      // At most 32 groups, whose bits have a type of their own.
      const hn::CappedTag<uint64_t, 4> d;
      const hn::Repartition<GroupBits<kGroup>, decltype(d)> of_group;
      const size_t lanes = hn::Lanes(d);
      for (; kIsLittleEndian && w + lanes <= left; w += lanes) {
        const auto vector =
            hn::BitCast(of_group, hn::LoadU(d, row + begin + w));
        bits |= LaneBits(of_group, hn::Ne(vector, hn::Zero(of_group)))
                << (kInWord * w);
      }
#endif
      for (; w < left; ++w) {
        for (size_t g = 0; g < kInWord; ++g) {
          const uint64_t group = row[begin + w] >> (kGroup * g);
          const bool is_left = (group & kLowBits<kGroup>) != 0;
          bits |= uint64_t{is_left} << (kInWord * w + g);
        }
      }
    }
    bits_[begin / kGroup] = bits;
    found += hwy::PopCount(bits);
  }
  return found;
}

template <size_t kGroup>
template <class Kept>
HWY_INLINE size_t Groups<kGroup>::Visit(uint64_t* HWY_RESTRICT row,
                                        bool is_last, const Kept& kept) {
  for (size_t w = 0; w < words_; w += kGroup) {
    for (uint64_t bits = bits_[w / kGroup]; bits != 0; bits &= bits - 1) {
      const size_t group =
          w * kInWord + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      AndGroup<kGroup>(row, group, kept(group * kGroup));
    }
  }
  return is_last ? 0 : Find(row, words_);
}

#endif  // HALFSPACE_MASKED_COMPARES

// NonzeroWords() as a function (words.cc).
uint64_t FindNonzeroWords(const uint64_t* words, size_t count);

// The number of bits in those of at most 64 words that `nonzero` names.
// Compiled per target, because the baseline of x86 has no popcnt.
size_t CountBits(const uint64_t* words, uint64_t nonzero);

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_WORDS_INL_H_
