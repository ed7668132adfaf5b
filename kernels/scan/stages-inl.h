// Scans that do not test all planes of an object at once. Where planes are
// streamed from memory, they test page by page. In stages, each stage tests
// only the objects that survived the stage before.
#if defined(HALFSPACE_KERNELS_SCAN_STAGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
#undef HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/compiler.h"
#include "kernels/scan/by_axis-inl.h"
#include "kernels/scan/few-inl.h"
#include "kernels/scan/flat-inl.h"
#include "kernels/scan/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The kernels that do not depend on the number of axes. They are compiled once
// for each type of element.
template <typename T>
struct ElementKernels {
  static int64_t StreamMinima(const detail::Scan& scan,
                              const detail::Chunk& chunk);
  static int64_t StreamAll(const detail::Scan& scan,
                           const detail::Chunk& chunk);
  static int64_t ByAxis(const detail::Scan& scan, const detail::Chunk& chunk);
  static int64_t ByHalf(const detail::Scan& scan, const detail::Chunk& chunk);
  static int64_t Adaptive(const detail::Scan& scan, const detail::Chunk& chunk);
};

// The whole words of a chunk.
HWY_INLINE size_t WordsOf(const detail::Chunk& chunk) {
  return (chunk.end - chunk.begin) / kWordObjects;
}

// The objects of a chunk from word `first` to object `end`. The fields are
// copied one by one, because a copy in vectors would wait for the stores of the
// fields.
HWY_INLINE detail::Chunk ChunkFrom(const detail::Chunk& chunk, size_t first,
                                   size_t end) {
  return {.first_query = chunk.first_query,
          .query_count = chunk.query_count,
          .queries = chunk.queries,
          .begin = chunk.begin + first * kWordObjects,
          .end = end,
          .rows = chunk.rows + first,
          .stride = chunk.stride};
}

// `count` queries of a chunk, from query q on.
HWY_INLINE detail::Chunk QueriesFrom(const detail::Scan& scan,
                                     const detail::Chunk& chunk, size_t q,
                                     size_t count) {
  return {.first_query = chunk.first_query + q,
          .query_count = count,
          .queries = static_cast<const char*>(chunk.queries) +
                     q * scan.type->record_bytes,
          .begin = chunk.begin,
          .end = chunk.end,
          .rows = chunk.rows + q * chunk.stride,
          .stride = chunk.stride};
}

// Calls test(tile) with the chunk of one tile after the other, of one query
// after the other.
template <class Test>
HWY_INLINE void ForEachTile(const detail::Scan& scan,
                            const detail::Chunk& chunk, const Test& test) {
  const size_t words = WordsOf(chunk);
  for (size_t q = 0; q < chunk.query_count; ++q) {
    const detail::Chunk of_query = QueriesFrom(scan, chunk, q, 1);
    for (size_t w = 0; w < words; w += kTileWords) {
      const size_t end = HWY_MIN(w + kTileWords, words);
      test(ChunkFrom(of_query, w, chunk.begin + end * kWordObjects));
    }
  }
}

// Tests the objects after the last whole word of a chunk, on all planes at
// once.
HWY_INLINE int64_t FinishChunk(const detail::Scan& scan,
                               const detail::Chunk& chunk,
                               detail::ScanKernel kernel) {
  const size_t words = WordsOf(chunk);
  if (chunk.begin + words * kWordObjects == chunk.end) return HWY_TARGET;
  return scan.kernels->run[kernel](scan, ChunkFrom(chunk, words, chunk.end));
}

// ---- Streaming: one query over planes out of the caches.

// The targets that stream. Plain code packs bits one by one, and would repeat
// that for every two planes: streaming took more than twice as long.
inline constexpr bool kHasStreaming = HWY_ARCH_X86 && kHasVectors;

// One page of each plane. For quantized bounds of one byte, half a page is 5 %
// faster.
template <typename T>
inline constexpr size_t kPageWords = HWY_MIN(size_t{32},
                                             4096 / (kWordObjects * sizeof(T)));

// Prefetches the first words of two planes.
template <typename T>
HWY_INLINE void PrefetchWords(const T* a, const T* b) {
  for (const T* word : {a, b}) {
    for (size_t i = 0; i < kWordObjects; i += 64 / sizeof(T)) {
      kernels::Prefetch(word + i);
    }
  }
}

// Tests a page of two planes, then a page of the next two planes. The two
// planes are the minima and maxima of one axis. Without maxima, they are the
// minima of two axes, and the last axis is alone if the number of axes is odd.
// So the prefetchers follow two streams instead of eight: an octahedron in L3
// takes 0.34 ns instead of 0.48 on Zen 4 (AVX2), a box 0.25 instead of 0.28.
// Prefetching the beginning of the next pages gains 3 %. Prefetching more of
// them was slower at any distance. With AVX-512 the vectors have 256 bits:
// where streaming pays, 512 bits do not.
template <bool kWithMaxima, typename T, class Load>
HWY_INLINE void StreamPages(Load load, const detail::Scan& scan,
                            const detail::Chunk& chunk) {
  const size_t axes = scan.type->axes;
  const T* values = static_cast<const T*>(chunk.queries);
  const T* max_values = values + scan.type->first_max;
  // The planes that are tested with the minima of axis k.
  const auto partner = [&](size_t k) {
    return scan.Plane<T>(kWithMaxima ? axes + k : HWY_MIN(k + 1, axes - 1));
  };
  constexpr size_t kStep = kWithMaxima ? 1 : 2;
  const size_t words = WordsOf(chunk);
  for (size_t w = 0; w < words; w += kPageWords<T>) {
    const size_t first = chunk.begin + w * kWordObjects;
    const size_t count = HWY_MIN(kPageWords<T>, words - w);
    for (size_t k = 0; k < axes; k += kStep) {
      const bool is_last = k + kStep >= axes;
      if (!is_last || w + count < words) {
        const size_t next = is_last ? 0 : k + kStep;
        const size_t from = is_last ? first + count * kWordObjects : first;
        PrefetchWords(scan.Plane<T>(next) + from, partner(next) + from);
      }
      const auto test = [&](const auto& group) HWY_ATTR {
        TestAll<Pack::kInstructions>(OneTag<T>(), load, group, k == 0, count,
                                     chunk.rows + w);
      };
      const T* const minima = scan.Plane<T>(k) + first;
      if constexpr (kWithMaxima) {
        test(AxesFrom<1>(scan, values, k, first));
      } else if (k + 1 < axes) {
        test(PlaneGroup<2, 2, T>{{minima, partner(k) + first},
                                 {max_values[k], max_values[k + 1]}});
      } else {
        test(PlaneGroup<1, 1, T>{{minima}, {max_values[k]}});
      }
    }
  }
}

template <typename T>
int64_t ElementKernels<T>::StreamMinima(const detail::Scan& scan,
                                        const detail::Chunk& chunk) {
  // Only boxes have doubles.
  if constexpr (kHasStreaming && !std::is_same_v<T, double>) {
    WithLoad<T>(scan, chunk.begin, [&](auto load) HWY_ATTR {
      StreamPages<false, T>(load, scan, chunk);
    });
    return FinishChunk(scan, chunk, detail::kMinima);
  } else {
    return scan.kernels->run[detail::kMinima](scan, chunk);
  }
}

template <typename T>
int64_t ElementKernels<T>::StreamAll(const detail::Scan& scan,
                                     const detail::Chunk& chunk) {
  if constexpr (kHasStreaming) {
    WithLoad<T>(scan, chunk.begin, [&](auto load) HWY_ATTR {
      StreamPages<true, T>(load, scan, chunk);
    });
    return FinishChunk(scan, chunk, detail::kAll);
  } else {
    return scan.kernels->run[detail::kAll](scan, chunk);
  }
}

// ---- By axis (by_axis-inl.h). Quantized bounds have no such stages.

template <size_t kFirst, typename T>
HWY_INLINE int64_t ChunkByAxis(const detail::Scan& scan,
                               const detail::Chunk& chunk) {
  if constexpr (std::is_floating_point_v<T>) {
    ForEachTile(scan, chunk, [&](const detail::Chunk& tile) HWY_ATTR {
      TileByAxis<kFirst, T>(scan, tile);
    });
    return FinishChunk(scan, chunk, detail::kAll);
  } else {
    return scan.kernels->run[detail::kAll](scan, chunk);
  }
}

template <typename T>
int64_t ElementKernels<T>::ByAxis(const detail::Scan& scan,
                                  const detail::Chunk& chunk) {
  return ChunkByAxis<1, T>(scan, chunk);
}

template <typename T>
int64_t ElementKernels<T>::ByHalf(const detail::Scan& scan,
                                  const detail::Chunk& chunk) {
  return ChunkByAxis<2, T>(scan, chunk);
}

// ---- By simplex: an octahedron's minima, then its maxima for the nonzero
// words, which are few.

// Prefetches the maxima of the nonzero words of a tile, before the minima of
// the next tile are tested. Out of the caches, each of these words would be a
// miss. If many words are nonzero, the maxima are read in order, and the
// hardware prefetches them.
//
// The lines of the planes alternate, so that the hardware does not take the
// four lines of one plane for the beginning of a stream.
template <size_t kAxes, typename T>
HWY_INLINE void PrefetchMaxima(const detail::Scan& scan,
                               const detail::Chunk& tile) {
  constexpr size_t kFew = 16;
  constexpr size_t kLine = 64 / sizeof(T);
  uint64_t nonzero = NonzeroWords(tile.rows, WordsOf(tile));
  if (hwy::PopCount(nonzero) > kFew) return;
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    const size_t i = tile.begin + w * kWordObjects;
    for (size_t line = 0; line < kWordObjects; line += kLine) {
      for (size_t k = 0; k < kAxes; ++k) {
        kernels::Prefetch(scan.Plane<T>(kAxes + k) + i + line);
      }
    }
  }
}

// Tests the maxima of a tile, one query after the other: of the words that have
// a survivor of the minima, or if many words have one, of the groups. A word of
// quantized bounds is only one or two vectors, so it has no groups.
template <size_t kAxes, typename T>
HWY_INLINE void TestMaxima(const detail::Scan& scan,
                           const detail::Chunk& tile) {
  ForEachTile(scan, tile, [&](const detail::Chunk& of_query) HWY_ATTR {
    const WordTag<T> d;
    const size_t words = WordsOf(of_query);
    uint64_t* HWY_RESTRICT const row = of_query.rows;
    uint64_t nonzero = NonzeroWords(row, words);
    if (nonzero == 0) return;
    const auto group = MaximaFrom<kAxes>(
        scan, static_cast<const T*>(of_query.queries), of_query.begin);
    if constexpr (std::is_floating_point_v<T>) {
      Groups<kGroupObjects> groups;
      if (4 * hwy::PopCount(nonzero) > words &&
          !Left{groups.Find(row, words), words * kWordGroups}.IsAlmostAll()) {
        TestGroups(d, LoadAll(), group, groups, true, row);
        return;
      }
    }
    group.With(d, [&](const T* const* planes, auto... compared) HWY_ATTR {
      for (; nonzero != 0; nonzero &= nonzero - 1) {
        const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
        row[w] &=
            KeptBits<0>(d, LoadAll(), planes, w * kWordObjects, compared...);
      }
    });
  });
}

template <size_t kAxes, typename T>
int64_t BySimplex(const detail::Scan& scan, const detail::Chunk& chunk) {
  detail::Chunk before = ChunkFrom(chunk, 0, chunk.begin);
  for (size_t w = 0; w < WordsOf(chunk); w += kTileWords) {
    const size_t end = HWY_MIN(w + kTileWords, WordsOf(chunk));
    const detail::Chunk tile =
        ChunkFrom(chunk, w, chunk.begin + end * kWordObjects);
    if (scan.is_streaming) {
      scan.kernels->run[detail::kMinimaStreaming](scan, tile);
      PrefetchMaxima<kAxes, T>(scan, tile);
    } else {
      Flat<kAxes, 0, T>(scan, tile);
    }
    // While the tile's maxima are being fetched.
    TestMaxima<kAxes, T>(scan, before);
    before = tile;
  }
  TestMaxima<kAxes, T>(scan, before);
  return FinishChunk(scan, chunk, detail::kAll);
}

// ---- kAuto: how much of a tile survives decides how the next is tested.

// From the fewest planes that all objects are tested on, to all of them. The
// half of a box is its first axes, that of an octahedron its minima.
enum Step : size_t { kOneAxis, kHalf, kEveryPlane };

// A step is kept while it leaves from `least` to `most` 64ths of each tile. If
// a tile leaves more, the next step follows. If `tiles` tiles in a row leave
// fewer, the step before it follows.
struct KeptStep {
  size_t least;
  size_t most;
  size_t tiles;
};
inline constexpr KeptStep kKeptOneAxis = {
    0, HALFSPACE_MASKED_COMPARES ? 36 : 24, 1};
inline constexpr KeptStep kKeptSteps[2][2][3] = {
    {
        // Boxes: groups that have a survivor of the first axes; of the last
        // step, nonzero words. Masked compares skip groups at less cost.
        {kKeptOneAxis, {HALFSPACE_MASKED_COMPARES ? 4 : 1, 48, 1}, {40, 64, 1}},
        // Octahedra: the same groups, then nonzero words, which are few.
        {kKeptOneAxis, {1, 48, 16}, {32, 64, 1}},
    },
    // In memory a plane that is read in parts takes as long as a whole one, so
    // the first step is the half, and the last follows earlier.
    {
        {{}, {0, 6, 1}, {3, 64, 1}},
        {{}, {0, 24, 16}, {12, 64, 1}},
    },
};

// Tests a tile of one query, and returns what of it is left, as above.
template <typename T>
HWY_INLINE Left TestTile(const detail::Scan& scan, const detail::Chunk& tile,
                         size_t step) {
  const bool is_box = scan.type->kind == detail::PlaneLayout::kAabb;
  if (step == kOneAxis) return TileByAxis<1, T>(scan, tile);
  if (step == kHalf && is_box) {
    return scan.type->axes > 2 ? TileByAxis<2, T>(scan, tile)
                               : TileByAxis<1, T>(scan, tile);
  }
  scan.kernels->run[step == kHalf       ? detail::kBySimplex
                    : scan.is_streaming ? detail::kAllStreaming
                                        : detail::kAll](scan, tile);
  return {hwy::PopCount(NonzeroWords(tile.rows, WordsOf(tile))), WordsOf(tile)};
}

// Tests two words of the first query on the first axis, to decide how to begin.
// It writes nothing.
template <typename T>
HWY_INLINE Left LookAt(const detail::Scan& scan, const detail::Chunk& chunk) {
  const WordTag<T> d;
  size_t some = 0;
  for (size_t w : {size_t{0}, WordsOf(chunk) / 2}) {
    AxesFrom<1>(scan, static_cast<const T*>(chunk.queries), 0,
                chunk.begin + w * kWordObjects)
        .With(d, [&](const T* const* planes, auto... values) HWY_ATTR {
          const uint64_t kept = KeptBits<1>(d, LoadAll(), planes, 0, values...);
          for (size_t g = 0; g < kWordObjects; g += kGroupObjects) {
            some += (kept >> g & kLowBits<kGroupObjects>) != 0;
          }
        });
  }
  return {some, 2 * kWordGroups};
}

// Fewer words of one query are tested flat, because the branches of stages cost
// more than they save. For several queries the limit is half as high, because
// each begins with the step that the query before it ended with. In plain code
// one word by axis takes half of the time of a flat word (a box on Zen 3).
inline constexpr size_t kFewWords =
    kHasVectors ? 2 * HWY_MIN(size_t{8}, hn::MaxLanes(OneTag<float>())) : 1;

template <typename T>
int64_t ElementKernels<T>::Adaptive(const detail::Scan& scan,
                                    const detail::Chunk& chunk) {
  if constexpr (!std::is_floating_point_v<T>) {
    return scan.kernels->run[detail::kAll](scan, chunk);
  } else if constexpr (!kHasVectors) {
    return ByAxis(scan, chunk);
  } else {
    const bool is_box = scan.type->kind == detail::PlaneLayout::kAabb;
    const bool is_one = chunk.query_count == 1;
    const auto run = [&](detail::ScanKernel kernel) {
      return scan.kernels->run[kernel](scan, chunk);
    };
    // Several octahedra share the loads of their minima. If there are few, and
    // few of them are near the query, kBySimplex takes 0.6 to 0.9 of the time
    // of a flat scan. Its worst case is better than that of kByAxis: 1.3 times
    // the time of a flat scan (objects of 0.1 %) instead of 1.6 (objects of
    // 10 %).
    if (!is_box && (!is_one || WordsOf(chunk) < kTileWords / 2)) {
      return run(detail::kBySimplex);
    }
    if (WordsOf(chunk) < (is_one ? kFewWords : kFewWords / 2)) {
      return run(detail::kAll);
    }
    if (HALFSPACE_MASKED_COMPARES && !is_one) {
      // Several boxes that are tested flat share loads, so the rest of a batch
      // is tested flat after a query that leaves half of the groups.
      size_t q = 0;
      for (bool is_few = true; is_few && q < chunk.query_count; ++q) {
        const detail::Chunk of_query = QueriesFrom(scan, chunk, q, 1);
        const Left left = TileByAxis<1, T>(scan, of_query);
        is_few = 2 * left.some <= left.all;
        FinishChunk(scan, of_query, detail::kAll);
      }
      if (q == chunk.query_count) return HWY_TARGET;
      return scan.kernels->run[detail::kAll](
          scan, QueriesFrom(scan, chunk, q, chunk.query_count - q));
    }
    Left look{};
    if (is_one) look = LookAt<T>(scan, chunk);
    const KeptStep* const steps = kKeptSteps[scan.is_in_memory][is_box ? 0 : 1];
    size_t step = is_box && look.IsAlmostAll() ? kEveryPlane : kHalf;
    if (!scan.is_in_memory &&
        64 * look.some <= steps[kOneAxis].most * look.all) {
      step = kOneAxis;
    }
    size_t tiles = 0;  // in a row that left fewer
    ForEachTile(scan, chunk, [&](const detail::Chunk& tile) HWY_ATTR {
      const Left left = TestTile<T>(scan, tile, step);
      const KeptStep& kept = steps[step];
      tiles = 64 * left.some < kept.least * left.all ? tiles + 1 : 0;
      if (64 * left.some > kept.most * left.all) {
        ++step;
      } else if (tiles == kept.tiles) {
        --step;
        tiles = 0;
      }
    });
    return FinishChunk(scan, chunk, detail::kAll);
  }
}

// ---- The table of a target.

template <size_t kAxes, typename T>
constexpr detail::TargetKernels MakeKernels() {
  detail::TargetKernels kernels{};
  kernels.nonzero_words = &FindNonzeroWords;
  kernels.count_bits = &CountBits;
  kernels.run[detail::kAll] = &Flat<kAxes, kAxes, T>;
  kernels.run[detail::kAllStreaming] = &ElementKernels<T>::StreamAll;
  if constexpr (std::is_floating_point_v<T>) {
    kernels.mask_of_all[0] = &FewMask<kAxes, OneTag<T>>;
    kernels.mask_of_all[1] = &FewMask<kAxes, WordTag<T>>;
    constexpr size_t kMostWords =
        !kHasVectors                ? 0
        : !std::is_same_v<T, float> ? kFewWords - 1
        : HALFSPACE_MASKED_COMPARES ? kNearObjects<2 * kAxes, T> / kWordObjects
                                    : kTileWords;
    kernels.few_objects = (kMostWords + 1) * kWordObjects - 1;
    kernels.few_octahedra =
        HALFSPACE_MASKED_COMPARES ? kNearObjects<2 * kAxes, T>
        : kHasVectors
            ? 48 * HWY_MIN(size_t{8}, hn::MaxLanes(OneTag<float>())) - 1
            : kWordObjects - 1;
    kernels.run[detail::kByAxis] = &ElementKernels<T>::ByAxis;
    kernels.run[detail::kByHalf] =
        kAxes > 2 ? &ElementKernels<T>::ByHalf : &ElementKernels<T>::ByAxis;
    kernels.run[detail::kAdaptive] = &ElementKernels<T>::Adaptive;
  }
  if constexpr (kAxes > 2 && !std::is_same_v<T, double>) {
    kernels.run[detail::kMinima] = &Flat<kAxes, 0, T>;
    if constexpr (std::is_floating_point_v<T>) {
      kernels.mask_of_minima[0] = &FlatMask<kAxes, 0, OneTag<T>>;
      kernels.mask_of_minima[1] = &FlatMask<kAxes, 0, WordTag<T>>;
    }
    kernels.run[detail::kMinimaStreaming] = &ElementKernels<T>::StreamMinima;
    kernels.run[detail::kBySimplex] = &BySimplex<kAxes, T>;
  }
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
