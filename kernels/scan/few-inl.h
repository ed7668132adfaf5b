// A few boxes for one query: on all planes at once, or in two stages if the
// first axis rejects many of a sample. All in one call, because a scan of 1000
// boxes takes 100 ns.
#if defined(HALFSPACE_KERNELS_SCAN_FEW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_FEW_INL_H_
#undef HALFSPACE_KERNELS_SCAN_FEW_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_FEW_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/scan/flat-inl.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The objects that the second stage tests together: a vector or two.
inline constexpr size_t kStageGroup = HWY_HAVE_SCALABLE ? kWordObjects : 8;

// Tests the first axes of all objects, and then the last axes of the groups
// that have a survivor. Which groups these are cannot be predicted, so there is
// one loop over them. The first `done` words are already tested on axis 0.
template <size_t kAxes, class D, typename T, size_t... kFirst, size_t... kLast>
HWY_NOINLINE void TwoStages(std::index_sequence<kFirst...>,
                            std::index_sequence<kLast...>, D d,
                            const T* const* planes, QueryValues<T> query,
                            size_t begin, size_t done, size_t words,
                            uint64_t* HWY_RESTRICT row) noexcept {
  constexpr size_t kAfter = sizeof...(kFirst);
  constexpr size_t kGroup = kStageGroup;
  const T* first[] = {planes[kFirst] + begin...,
                      planes[kAxes + kFirst] + begin...};
  const T* last[] = {planes[kAfter + kLast] + begin...,
                     planes[kAxes + kAfter + kLast] + begin...};
  for (size_t w = done; w < words; ++w) {
    row[w] = KeptBits<kAfter>(d, LoadAll(), first, w * kWordObjects,
                              hn::Set(d, query.max[kFirst])...,
                              hn::Set(d, query.min[kFirst])...);
  }
  Groups<kGroup> groups;
  groups.Find(row, words);
  groups.Visit(row, true, [&](size_t i) HWY_ATTR {
    return KeptBits<sizeof...(kLast), kGroup>(
        d, LoadAll(), last, i, hn::Set(d, query.max[kAfter + kLast])...,
        hn::Set(d, query.min[kAfter + kLast])...);
  });
}

// At least one word. A sample, an eighth of the objects, is tested on the first
// axis. The share of its groups with a survivor chooses how many axes the first
// stage tests. With uniform boxes of 1 % of the world's side, 15 % of the
// groups of 8 have a survivor. With boxes of 3 % it is 39 %, of 10 % it is 83
// %.
template <size_t kAxes, class D, typename T>
HWY_NOINLINE void SampledMask(const T* const* planes, size_t begin,
                              size_t count, const T* values,
                              uint64_t* row) noexcept {
  constexpr size_t kGroup = kStageGroup;
  // The most groups with a survivor, of 16, for a first stage of one axis, and
  // for two stages.
  constexpr size_t kMostForOneAxis = kGroup == 8 ? 4 : 7;
  constexpr size_t kMostForStages = kGroup == 8 ? 10 : 12;
  constexpr size_t kHalf = (kAxes + 1) / 2;
  const D d;
  const auto query = ValuesOf<kAxes, kAxes>(values);
  const size_t words = count / kWordObjects;
  const size_t sample_words = (words + 7) / 8;
  const T* axis[] = {planes[0] + begin, planes[kAxes] + begin};
  size_t kept_groups = 0;
  for (size_t w = 0; w < sample_words; ++w) {
    row[w] = KeptBits<1>(d, LoadAll(), axis, w * kWordObjects,
                         hn::Set(d, query.max[0]), hn::Set(d, query.min[0]));
    // The lowest bit of each group becomes the OR of its bits. In a register,
    // because words that were just stored are read late.
    uint64_t any = row[w];
    for (size_t s = kGroup / 2; s != 0; s /= 2) any |= any >> s;
    kept_groups += hwy::PopCount(any & (~uint64_t{0} / kLowBits<kGroup>));
  }
  const size_t groups = sample_words * (kWordObjects / kGroup);
  if (16 * kept_groups > kMostForStages * groups) {
    FlatMask<kAxes, kAxes, D>(planes, begin, count, values, row);
    return;
  }
  if (16 * kept_groups <= kMostForOneAxis * groups) {
    TwoStages<kAxes>(std::make_index_sequence<1>(),
                     std::make_index_sequence<kAxes - 1>(), d, planes, query,
                     begin, sample_words, words, row);
  } else {
    TwoStages<kAxes>(std::make_index_sequence<kHalf>(),
                     std::make_index_sequence<kAxes - kHalf>(), d, planes,
                     query, begin, 0, words, row);
  }
  if (count % kWordObjects != 0) {
    FlatTail<kAxes, kAxes>(planes, query, begin + words * kWordObjects,
                           count % kWordObjects, row + words);
  }
}

// A MaskKernel (kernel_table.h) for floats. With fewer words, stages cost more
// than they save, and with more, the choice of Adaptive() is better. With
// masked compares it is better at once.
template <size_t kAxes, class D>
HWY_NOINLINE void FewMask(const void* pointers, size_t begin, size_t count,
                          const void* values, uint64_t* row) noexcept {
  using T = hn::TFromD<D>;
  if constexpr (kHasVectors && std::is_same_v<T, float> &&
                !HALFSPACE_MASKED_COMPARES) {
    constexpr size_t kFewest = HWY_MIN(size_t{9}, hn::MaxLanes(D()));
    const size_t words = count / kWordObjects;
    if (words >= kFewest && words <= kTileWords) {
      SampledMask<kAxes, D>(static_cast<const T* const*>(pointers), begin,
                            count, static_cast<const T*>(values), row);
      return;
    }
  }
  FlatMask<kAxes, kAxes, D>(pointers, begin, count, values, row);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_FEW_INL_H_
