// The same planes of every object, without a branch: all of them at once, or
// two at a time where they come from afar.
#if defined(HALFSPACE_KERNELS_FLAT_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FLAT_WORDS_INL_H_
#undef HALFSPACE_KERNELS_FLAT_WORDS_INL_H_
#else
#define HALFSPACE_KERNELS_FLAT_WORDS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/prefetch.h"
#include "kernels/together-inl.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A page of each plane; of codes half a page is 5 % faster.
template <typename T>
inline constexpr size_t kPageWords = HWY_MIN(size_t{32},
                                             4096 / (kWordObjects * sizeof(T)));

template <class Shape, size_t kPlanes, class D, class Load, typename T,
          class... V>
HWY_INLINE void NearWords(D d, Load load, const T* const* planes, size_t first,
                          size_t words, uint64_t* row, uint64_t flip,
                          V... query) {
  for (size_t w = 0; w < words; ++w) {
    row[w] = BitsRejected<Shape, kWordObjects, 0, kPlanes>(
                 d, load, planes, first + w * kWordObjects, query...) ^
             flip;
  }
}

// Asks for the first word of planes [kBegin, kEnd) from object `first` on.
template <class Shape, size_t kBegin, size_t kEnd, typename T>
HWY_INLINE void PrefetchWord(const T* const* planes, size_t first) {
  if constexpr (kBegin < kEnd) {
    const T* plane = planes[kernels::kObjectIndex<Shape, kBegin>] + first;
    for (size_t i = 0; i < kWordObjects; i += 64 / sizeof(T)) {
      kernels::Prefetch(plane + i);
    }
    PrefetchWord<Shape, kBegin + 1, kEnd>(planes, first);
  }
}

// Planes kNow ... kPlanes - 1, added to what those before have rejected. Then
// the planes begin again at object `next`, unless that is `first`.
template <class Shape, size_t kNow, size_t kPlanes, class D, class Load,
          typename T, class... V>
HWY_INLINE void AddPlanePairs(D d, Load load, const T* const* planes,
                              size_t first, size_t next, size_t words,
                              uint64_t* row, uint64_t flip, V... query) {
  constexpr size_t kEnd = HWY_MIN(kNow + 2, kPlanes);
  if constexpr (kEnd < kPlanes) {
    PrefetchWord<Shape, kEnd, HWY_MIN(kEnd + 2, kPlanes)>(planes, first);
  } else if (next != first) {
    PrefetchWord<Shape, 0, 2>(planes, next);
  }
  for (size_t w = 0; w < words; ++w) {
    const uint64_t before = kNow == 0 ? 0 : row[w] ^ flip;
    row[w] =
        (before |
         BitsRejected<Shape, kWordObjects, kNow, kEnd, Pack::kInstructions>(
             d, load, planes, first + w * kWordObjects, query...)) ^
        flip;
  }
  if constexpr (kEnd < kPlanes) {
    AddPlanePairs<Shape, kEnd, kPlanes>(d, load, planes, first, next, words,
                                        row, flip, query...);
  }
}

// Where it was measured. Plain code packs bits one by one, for each two planes
// anew, and took more than twice as long.
inline constexpr bool kPagesPay = HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR;

// A page of two planes after a page of two others. Prefetchers follow two
// streams, and not eight: an octahedron in L3 takes 0.34 ns instead of 0.48 on
// Zen 4 (AVX2), a box 0.25 instead of 0.28. To ask for more than where the next
// pages begin, which gains 3 %, was slower at any distance.
template <class Shape, size_t kPlanes, class D, class Load, typename T,
          class... V>
HWY_INLINE void FarWords(D d, Load load, const T* const* planes, size_t first,
                         size_t words, uint64_t* row, uint64_t flip,
                         V... query) {
  size_t next = first;
  for (size_t left = words; left != 0;) {
    const size_t count = HWY_MIN(kPageWords<T>, left);
    left -= count;
    first = next;
    if (left != 0) next = first + count * kWordObjects;
    AddPlanePairs<Shape, 0, kPlanes>(d, load, planes, first, next, count, row,
                                     flip, query...);
    row += count;
  }
}

template <class Shape, size_t kPlanes, bool kIsFar, class Load, typename T,
          size_t... kPlane>
HWY_INLINE void WordsOfOne(std::index_sequence<kPlane...>, Load load,
                           const T* const* planes, const T* values,
                           size_t first, size_t words, uint64_t* row,
                           uint64_t flip) {
  const OneTag<T> d;
  if constexpr (kIsFar && kPagesPay) {
    FarWords<Shape, kPlanes>(
        d, load, planes, first, words, row, flip,
        hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
  } else {
    NearWords<Shape, kPlanes>(
        d, load, planes, first, words, row, flip,
        hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
  }
}

// The first kPlanes planes of `words` whole words from object `first` on, for
// kQueries queries. `row` has the word of `first` for the first query.
template <class Shape, size_t kPlanes, size_t kQueries, bool kIsFar, class Load,
          typename T>
HWY_INLINE void ScanWordsFlat(Load load, const T* const* planes,
                              const T* values, size_t first, size_t words,
                              uint64_t* row, size_t stride, uint64_t flip) {
  static_assert(kQueries == 1 || !kIsFar);
#if HALFSPACE_MASKED_COMPARES
  if constexpr (kQueries > 1) {
    return WordsTogether<Shape, kPlanes, kQueries>(planes, values, first, words,
                                                   row, stride, flip);
  }
#endif
  static_assert(kQueries == 1 || HALFSPACE_MASKED_COMPARES);
  (void)stride;
  WordsOfOne<Shape, kPlanes, kIsFar>(std::make_index_sequence<kPlanes>(), load,
                                     planes, values, first, words, row, flip);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FLAT_WORDS_INL_H_
