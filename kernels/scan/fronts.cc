// The kernels of flat scans for half-spaces, of every target. They read a list
// of planes, so that there is one for all worlds of floats.
#include "kernels/scan/fronts.h"

#include <cstddef>
#include <cstdint>

#include "kernels/compiled_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/scan/fronts.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

// After foreach_target.h, which decides what they are compiled for.
#include "kernels/bvh/front-inl.h"
#include "kernels/scan/words-inl.h"

#ifndef HALFSPACE_KERNELS_SCAN_FRONTS_CC_
#define HALFSPACE_KERNELS_SCAN_FRONTS_CC_

namespace halfspace::detail {

template <std::int64_t kTarget>
inline constexpr TargetKernels kFrontKernelsFor{};

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_SCAN_FRONTS_CC_

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A vector of objects at a time, so that the first half-space that has all of
// them behind it ends their test.
template <class D, class Load>
HWY_INLINE uint64_t FrontBits(D d, Load load, const float* const* planes,
                              const detail::Fronts& query, size_t i) {
  uint64_t kept = ~uint64_t{0} >> (kWordObjects - hn::Lanes(d));
  for (size_t f = 0; f < query.count && kept != 0; ++f) {
    const auto sum = FrontSum(d, query.front[f],
                              [&](const detail::Front::Term& term) HWY_ATTR {
                                return load(d, planes[term.plane] + i);
                              });
    kept &= ~LaneBits(d, hn::Lt(sum, hn::Zero(d)));
  }
  return kept;
}

HWY_INLINE uint64_t FrontWord(const float* const* planes,
                              const detail::Fronts& fronts, size_t begin,
                              size_t count) {
  const WordTag<float> d;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  size_t l = 0;
  for (; l + lanes <= count; l += lanes) {
    bits |= FrontBits(d, LoadAll(), planes, fronts, begin + l) << l;
  }
  if (l == count) return bits;
  const LoadFirst load{count - l};
  bits |= FrontBits(d, load, planes, fronts, begin + l) << l;
  return bits & ~(~uint64_t{0} << count);
}

void FrontMask(const void* pointers, size_t begin, size_t count,
               const void* query, uint64_t* words) noexcept {
  const auto* planes = static_cast<const float* const*>(pointers);
  const auto& fronts = *static_cast<const detail::Fronts*>(query);
  for (size_t i = 0; i < count; i += kWordObjects) {
    *words++ =
        FrontWord(planes, fronts, begin + i, HWY_MIN(kWordObjects, count - i));
  }
}

int64_t FrontRow(const detail::Scan& scan, const detail::Part& part) {
  FrontMask(scan.planes, part.begin, part.end - part.begin, part.queries,
            part.rows);
  return HWY_TARGET;
}

constexpr detail::TargetKernels MakeFrontKernels() {
  detail::TargetKernels kernels{};
  kernels.nonzero_words = &FindNonzeroWords;
  kernels.count_bits = &CountBits;
  for (detail::Kernel& kernel : kernels.run) kernel = &FrontRow;
  kernels.mask_of_minima = &FrontMask;
  kernels.mask_of_all = &FrontMask;
  kernels.few_objects = detail::kFewObjects;
  return kernels;
}

}  // namespace HWY_NAMESPACE

namespace detail {

template <>
inline constexpr TargetKernels kFrontKernelsFor<HWY_TARGET> =
    HWY_NAMESPACE::MakeFrontKernels();

}  // namespace detail
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace halfspace::detail {
namespace {

constexpr auto kOfEachTarget = kernels::OfEachTarget<TargetKernels>(
    [](auto target) { return kFrontKernelsFor<target()>; });

}  // namespace

const TargetKernels* const kFrontKernels = kOfEachTarget.data();

}  // namespace halfspace::detail
#endif  // HWY_ONCE
