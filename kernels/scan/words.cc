// Functions of a target that every scan uses, whatever its planes.
#include <cstddef>
#include <cstdint>

#include "kernels/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/scan/words.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

uint64_t FindNonzeroWords(const uint64_t* words, size_t count) {
  return NonzeroWords(words, count);
}

size_t CountBits(const uint64_t* words, uint64_t nonzero) {
  size_t bits = 0;
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    bits += hwy::PopCount(words[hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero)]);
  }
  return bits;
}

size_t FloatLanes() { return hn::Lanes(hn::ScalableTag<float>()); }

}  // namespace HWY_NAMESPACE

namespace kernels {

template <>
std::size_t LanesOf<HWY_TARGET>() {
  return HWY_NAMESPACE::FloatLanes();
}

}  // namespace kernels
}  // namespace halfspace
HWY_AFTER_NAMESPACE();
