// Several queries that share each load: a tile of registers, where there are
// enough of them and loads bind.
#if defined(HALFSPACE_KERNELS_TOGETHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_TOGETHER_INL_H_
#undef HALFSPACE_KERNELS_TOGETHER_INL_H_
#else
#define HALFSPACE_KERNELS_TOGETHER_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// How many queries are tested at a time on kPlanes planes. With AVX-512, whose
// 32 registers hold four simplices, and whose cores load one vector a cycle, as
// many as they compare: a quarter less time (0.099 to 0.075 ns a pair for the
// simplex in L1 on Zen 4). AVX2 and SSE4 gain nothing: two loads a cycle, and
// too few registers.
template <size_t kPlanes>
inline constexpr size_t kQueriesTogether =
    !HALFSPACE_MASKED_COMPARES ? 1 : (kPlanes <= 6 ? 4 : 2);

#if HALFSPACE_MASKED_COMPARES

template <size_t kPlanes, size_t kQueries, class D>
struct QueryVectors {
  hn::Vec<D> planes[kPlanes][kQueries];
};

template <class Shape, size_t kPlane, size_t kPlanes, size_t... kQuery, class D,
          typename T>
HWY_INLINE void SetQueries(
    std::index_sequence<kQuery...> all, D d, const T* values,
    QueryVectors<kPlanes, sizeof...(kQuery), D>& queries) {
  constexpr size_t kValues = kernels::kQueryValues<Shape>;
  if constexpr (kPlane < kPlanes) {
    ((queries.planes[kPlane][kQuery] = hn::Set(
          d, values[kQuery * kValues + kernels::kQueryIndex<Shape, kPlane>])),
     ...);
    SetQueries<Shape, kPlane + 1>(all, d, values, queries);
  }
}

// Planes kPlane ... kPlanes - 1 of one vector of objects, for all the queries.
template <class Shape, size_t kPlane, size_t kPlanes, size_t... kQuery, class D,
          typename T>
HWY_INLINE void AddPlanes(
    std::index_sequence<kQuery...> all, D d, const T* const* planes, size_t i,
    const QueryVectors<kPlanes, sizeof...(kQuery), D>& queries,
    hn::Mask<D> (&kept)[sizeof...(kQuery)]) {
  if constexpr (kPlane < kPlanes) {
    constexpr kernels::Plane kTest = Shape::kOrder.planes[kPlane];
    const hn::Vec<D> object = hn::LoadU(d, planes[kTest.object] + i);
    if constexpr (kPlane == 0) {
      ((kept[kQuery] =
            FirstVerdict<kTest>(d, object, queries.planes[0][kQuery])),
       ...);
    } else {
      ((kept[kQuery] = NextVerdict<kTest>(d, kept[kQuery], object,
                                          queries.planes[kPlane][kQuery])),
       ...);
    }
    AddPlanes<Shape, kPlane + 1>(all, d, planes, i, queries, kept);
  }
}

// ORs the bits of one vector, which begins at bit `shift` of its word, into the
// words of survivors.
template <class Shape, size_t kPlanes, size_t... kQuery, class D, typename T>
HWY_INLINE void AddVector(
    std::index_sequence<kQuery...> all, D d, const T* const* planes, size_t i,
    size_t shift, const QueryVectors<kPlanes, sizeof...(kQuery), D>& queries,
    uint64_t (&survivors)[sizeof...(kQuery)]) {
  hn::Mask<D> kept[sizeof...(kQuery)];
  AddPlanes<Shape, 0>(all, d, planes, i, queries, kept);
  ((survivors[kQuery] |= LaneBits(d, kept[kQuery]) << shift), ...);
}

template <class Shape, size_t kPlanes, size_t... kVector, size_t... kQuery,
          class D, typename T>
HWY_INLINE void WordTogether(
    std::index_sequence<kVector...>, std::index_sequence<kQuery...> all, D d,
    const T* const* planes, size_t i,
    const QueryVectors<kPlanes, sizeof...(kQuery), D>& queries, uint64_t* row,
    size_t stride, uint64_t flip) {
  constexpr size_t kLanes = hn::MaxLanes(D());
  uint64_t survivors[sizeof...(kQuery)] = {};
  (AddVector<Shape>(all, d, planes, i + kVector * kLanes, kVector * kLanes,
                    queries, survivors),
   ...);
  ((row[kQuery * stride] = ~survivors[kQuery] ^ flip), ...);
}

// The first kPlanes planes of `words` whole words from object `first` on, for
// kQueries queries.
template <class Shape, size_t kPlanes, size_t kQueries, typename T>
HWY_INLINE void WordsTogether(const T* const* planes, const T* values,
                              size_t first, size_t words, uint64_t* row,
                              size_t stride, uint64_t flip) {
  const WordTag<T> d;
  constexpr std::make_index_sequence<kQueries> kAll{};
  constexpr std::make_index_sequence<kWordObjects / hn::MaxLanes(WordTag<T>())>
      kVectors{};
  QueryVectors<kPlanes, kQueries, WordTag<T>> queries;
  SetQueries<Shape, 0>(kAll, d, values, queries);
  for (size_t w = 0; w < words; ++w) {
    WordTogether<Shape>(kVectors, kAll, d, planes, first + w * kWordObjects,
                        queries, row + w, stride, flip);
  }
}

#endif  // HALFSPACE_MASKED_COMPARES

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_TOGETHER_INL_H_
