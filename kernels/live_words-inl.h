// Which words still have survivors: few do, and what comes after a test looks
// at those alone.
#if defined(HALFSPACE_KERNELS_LIVE_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_LIVE_WORDS_INL_H_
#undef HALFSPACE_KERNELS_LIVE_WORDS_INL_H_
#else
#define HALFSPACE_KERNELS_LIVE_WORDS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/lane_bits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Bit w of the result: words[w] is not `dead`. At most 64 words. Without a
// branch: which words live cannot be predicted.
HWY_INLINE uint64_t LiveWords(const uint64_t* words, size_t count,
                              uint64_t dead) {
  uint64_t live = 0;
  size_t w = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::CappedTag<uint64_t, 8> d;
  const size_t lanes = hn::Lanes(d);
  const auto all_dead = hn::Set(d, dead);
  // Four at a time: the shifts within are constants.
  constexpr size_t kUnroll = 4;
  for (; w + kUnroll * lanes <= count; w += kUnroll * lanes) {
    uint64_t bits = 0;
    for (size_t u = 0; u < kUnroll; ++u) {
      const auto vector = hn::LoadU(d, words + w + u * lanes);
      bits |= LaneBits(d, hn::Ne(vector, all_dead)) << (u * lanes);
    }
    live |= bits << w;
  }
  for (; w + lanes <= count; w += lanes) {
    live |= LaneBits(d, hn::Ne(hn::LoadU(d, words + w), all_dead)) << w;
  }
#endif
  for (; w < count; ++w) live |= uint64_t{words[w] != dead} << w;
  return live;
}

// Survivors, which are set bits, in at most 64 words of which `live` are not 0.
// Per target, because the baseline of x86 has no popcnt.
inline size_t CountSurvivors(const uint64_t* words, uint64_t live) {
  size_t bits = 0;
  for (; live != 0; live &= live - 1) {
    bits += hwy::PopCount(words[hwy::Num0BitsBelowLS1Bit_Nonzero64(live)]);
  }
  return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_LIVE_WORDS_INL_H_
