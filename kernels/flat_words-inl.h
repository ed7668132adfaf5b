// The same planes of every object, without a branch.
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
#include "kernels/together-inl.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class Shape, size_t kPlanes, class D, typename T, class... V>
HWY_INLINE void WordsOfOne(D d, const T* const* planes, size_t first,
                           size_t words, uint64_t* row, uint64_t flip,
                           V... query) {
  for (size_t w = 0; w < words; ++w) {
    row[w] = BitsRejected<Shape, kWordObjects, 0, kPlanes>(
                 d, planes, first + w * kWordObjects, query...) ^
             flip;
  }
}

template <class Shape, size_t kPlanes, typename T, size_t... kPlane>
HWY_INLINE void WordsOfOne(std::index_sequence<kPlane...>,
                           const T* const* planes, const T* values,
                           size_t first, size_t words, uint64_t* row,
                           uint64_t flip) {
  const WordTag<T> d;
  WordsOfOne<Shape, kPlanes>(
      d, planes, first, words, row, flip,
      hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
}

// The first kPlanes planes of `words` whole words from object `first` on, for
// kQueries queries. `row` has the word of `first` for the first query.
template <class Shape, size_t kPlanes, size_t kQueries, typename T>
HWY_INLINE void ScanWordsFlat(const T* const* planes, const T* values,
                              size_t first, size_t words, uint64_t* row,
                              size_t stride, uint64_t flip) {
#if HALFSPACE_MASKED_COMPARES
  if constexpr (kQueries > 1) {
    return WordsTogether<Shape, kPlanes, kQueries>(planes, values, first, words,
                                                   row, stride, flip);
  }
#endif
  static_assert(kQueries == 1 || HALFSPACE_MASKED_COMPARES);
  (void)stride;
  WordsOfOne<Shape, kPlanes>(std::make_index_sequence<kPlanes>(), planes,
                             values, first, words, row, flip);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FLAT_WORDS_INL_H_
