// A scan in two stages, of which the first leaves few words of 64 objects: an
// octahedron's up simplex, and then its down simplex.
#if defined(HALFSPACE_KERNELS_STAGED_WORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_STAGED_WORDS_INL_H_
#undef HALFSPACE_KERNELS_STAGED_WORDS_INL_H_
#else
#define HALFSPACE_KERNELS_STAGED_WORDS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/flat_words-inl.h"
#include "kernels/live_words-inl.h"
#include "kernels/prefetch.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// 4096 objects, whose words are one word of live bits.
inline constexpr size_t kStageWords = 64;

// The second stage's planes of the live words of a tile are on their way while
// the next tile's first stage runs: out of the caches each of them is a miss.
// Where many words live they come in order, and the hardware sees that.
template <class Shape, typename T, size_t... kPlane>
HWY_INLINE void PrefetchLive(std::index_sequence<kPlane...>,
                             const T* const* planes, size_t first,
                             uint64_t live) {
  constexpr size_t kFewLive = 16;
  constexpr size_t kLine = 64 / sizeof(T);
  constexpr size_t kBegin = Shape::kOrder.stage_ends[0];
  if (hwy::PopCount(live) > kFewLive) return;
  for (; live != 0; live &= live - 1) {
    const size_t i =
        first + kWordObjects * hwy::Num0BitsBelowLS1Bit_Nonzero64(live);
    for (size_t line = 0; line < kWordObjects; line += kLine) {
      (kernels::Prefetch(planes[kernels::kObjectIndex<Shape, kBegin + kPlane>] +
                         i + line),
       ...);
    }
  }
}

// The second stage of the live words of a tile. `row` has the tile's words.
template <class Shape, class D, class Load, typename T, class... V>
HWY_INLINE void FinishLive(D d, Load load, const T* const* planes, size_t first,
                           uint64_t live, uint64_t* row, uint64_t flip,
                           V... query) {
  constexpr size_t kBegin = Shape::kOrder.stage_ends[0];
  constexpr size_t kEnd = Shape::kOrder.stage_ends[1];
  for (; live != 0; live &= live - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(live);
    const uint64_t rejected = BitsRejected<Shape, kWordObjects, kBegin, kEnd>(
        d, load, planes, first + w * kWordObjects, query...);
    row[w] = ((row[w] ^ flip) | rejected) ^ flip;
  }
}

template <class Shape, size_t kQueries>
struct LiveTile {
  size_t word = 0;
  uint64_t live[kQueries] = {};
};

template <class Shape, size_t kQueries, class Load, typename T,
          size_t... kPlane>
HWY_INLINE void FinishTile(std::index_sequence<kPlane...>, Load load,
                           const T* const* planes, const T* values,
                           size_t first, const LiveTile<Shape, kQueries>& tile,
                           uint64_t* row, size_t stride, uint64_t flip) {
  const OneTag<T> d;
  for (size_t q = 0; q < kQueries; ++q) {
    if (tile.live[q] == 0) continue;
    const T* value = values + q * sizeof...(kPlane);
    FinishLive<Shape>(
        d, load, planes, first + tile.word * kWordObjects, tile.live[q],
        row + q * stride + tile.word, flip,
        hn::Set(d, value[kernels::kQueryIndex<Shape, kPlane>])...);
  }
}

// `words` whole words from object `first` on, for kQueries queries.
template <class Shape, size_t kQueries, bool kIsFar, class Load, typename T>
HWY_INLINE void ScanWordsStaged(Load load, const T* const* planes,
                                const T* values, size_t first, size_t words,
                                uint64_t* row, size_t stride, uint64_t flip) {
  constexpr size_t kFirst = Shape::kOrder.stage_ends[0];
  constexpr size_t kPlanes = Shape::kOrder.planes.size();
  constexpr std::make_index_sequence<kPlanes> kAll{};
  constexpr std::make_index_sequence<kPlanes - kFirst> kSecond{};
  LiveTile<Shape, kQueries> before;
  for (size_t begin = 0; begin < words; begin += kStageWords) {
    const size_t count = HWY_MIN(kStageWords, words - begin);
    const size_t tile_first = first + begin * kWordObjects;
    ScanWordsFlat<Shape, kFirst, kQueries, kIsFar>(
        load, planes, values, tile_first, count, row + begin, stride, flip);
    LiveTile<Shape, kQueries> tile;
    tile.word = begin;
    for (size_t q = 0; q < kQueries; ++q) {
      tile.live[q] = LiveWords(row + q * stride + begin, count, ~flip);
      if constexpr (kIsFar) {
        PrefetchLive<Shape>(kSecond, planes, tile_first, tile.live[q]);
      }
    }
    FinishTile(kAll, load, planes, values, first, before, row, stride, flip);
    before = tile;
  }
  FinishTile(kAll, load, planes, values, first, before, row, stride, flip);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_STAGED_WORDS_INL_H_
