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

// `words` words of query q of a chunk, from word `first` on.
HWY_INLINE detail::Chunk ChunkOf(const detail::Scan& scan,
                                 const detail::Chunk& chunk, size_t q,
                                 size_t first, size_t words) {
  return {.first_query = chunk.first_query + q,
          .query_count = 1,
          .queries = static_cast<const char*>(chunk.queries) +
                     q * scan.type->query_record_bytes,
          .begin = chunk.begin + first * kWordObjects,
          .end = chunk.begin + (first + words) * kWordObjects,
          .rows = chunk.rows + q * chunk.stride + first,
          .stride = chunk.stride};
}

// Tests the objects after the last whole word of a chunk, on all planes at
// once.
HWY_INLINE int64_t FinishChunk(const detail::Scan& scan,
                               const detail::Chunk& chunk,
                               detail::ScanKernel kernel) {
  const size_t words = (chunk.end - chunk.begin) / kWordObjects;
  if (chunk.begin + words * kWordObjects == chunk.end) return HWY_TARGET;
  return scan.kernels->run[kernel](scan, ChunkFrom(chunk, words, chunk.end));
}

// ---- Streaming: one query over planes out of the caches.

// Streaming is used where it was measured to be faster. Plain code packs bits
// one by one, and repeats that for every two planes: it took more than twice as
// long.
inline constexpr bool kPagesPay = HWY_ARCH_X86 && kHasVectors;

// One page of each plane. For quantized bounds of one byte, half a page is 5 %
// faster.
template <typename T>
inline constexpr size_t kPageWords = HWY_MIN(size_t{32},
                                             4096 / (kWordObjects * sizeof(T)));

// One or two planes of a scan, the first kMins of them minima, and what they
// are compared with.
template <typename T, size_t kPlanes>
struct PlaneGroup {
  const T* planes[kPlanes];
  T values[kPlanes];
};

// Prefetches the first words of two planes.
template <typename T>
HWY_INLINE void PrefetchWords(const T* a, const T* b) {
  for (const T* word : {a, b}) {
    for (size_t i = 0; i < kWordObjects; i += 64 / sizeof(T)) {
      kernels::Prefetch(word + i);
    }
  }
}

// Tests a page. The words of the first planes are stored, and the words of
// later planes are ANDed to them. Not inlined: inside the caller, gcc 12
// reloads the row's address from the stack for each word, which takes 56
// instructions instead of 51. With AVX-512 its vectors have 256 bits: where
// streaming pays, 512 bits do not.
template <size_t kMins, class Load, typename T, size_t kPlanes>
HWY_NOINLINE void TestPage(Load load, const PlaneGroup<T, kPlanes>& group,
                           bool is_first, size_t first, size_t words,
                           uint64_t* row) {
  const OneTag<T> d;
  const auto test = [&](size_t w) HWY_ATTR {
    if constexpr (kPlanes == 1) {
      return KeptBits<kMins, kWordObjects, Pack::kInstructions>(
          d, load, group.planes, first + w * kWordObjects,
          hn::Set(d, group.values[0]));
    } else {
      return KeptBits<kMins, kWordObjects, Pack::kInstructions>(
          d, load, group.planes, first + w * kWordObjects,
          hn::Set(d, group.values[0]), hn::Set(d, group.values[1]));
    }
  };
  if (is_first) {
    for (size_t w = 0; w < words; ++w) row[w] = test(w);
  } else {
    for (size_t w = 0; w < words; ++w) row[w] &= test(w);
  }
}

// Tests a page of two planes, then a page of the next two planes. The two
// planes are the minima and maxima of one axis. Without maxima, they are the
// minima of two axes, and the last axis is alone if the number of axes is odd.
// So the prefetchers follow two streams instead of eight: an octahedron in L3
// takes 0.34 ns instead of 0.48 on Zen 4 (AVX2), a box 0.25 instead of 0.28.
// Prefetching the beginning of the next pages gains 3 %. Prefetching more of
// them was slower at any distance.
template <bool kWithMaxima, typename T, class Load>
HWY_INLINE void StreamPages(Load load, const detail::Scan& scan,
                            const detail::Chunk& chunk) {
  const size_t axes = scan.type->axes;
  const T* min_values = static_cast<const T*>(chunk.queries);
  const T* max_values = min_values + scan.type->first_max;
  const auto plane = [&](size_t p) { return scan.Plane<T>(p); };
  // The second plane of a pair that begins with plane k.
  const auto partner = [&](size_t k) {
    return plane(kWithMaxima ? axes + k : HWY_MIN(k + 1, axes - 1));
  };
  constexpr size_t kStep = kWithMaxima ? 1 : 2;
  const size_t words = (chunk.end - chunk.begin) / kWordObjects;
  for (size_t w = 0; w < words; w += kPageWords<T>) {
    const size_t first = chunk.begin + w * kWordObjects;
    const size_t count = HWY_MIN(kPageWords<T>, words - w);
    uint64_t* row = chunk.rows + w;
    for (size_t k = 0; k < axes; k += kStep) {
      if (k + kStep < axes) {
        PrefetchWords(plane(k + kStep) + first, partner(k + kStep) + first);
      } else if (w + count < words) {
        const size_t next = first + count * kWordObjects;
        PrefetchWords(plane(0) + next, partner(0) + next);
      }
      if constexpr (kWithMaxima) {
        TestPage<1, Load, T, 2>(
            load, {{plane(k), plane(axes + k)}, {max_values[k], min_values[k]}},
            k == 0, first, count, row);
      } else if (k + 1 < axes) {
        TestPage<2, Load, T, 2>(
            load,
            {{plane(k), plane(k + 1)}, {max_values[k], max_values[k + 1]}},
            k == 0, first, count, row);
      } else {
        TestPage<1, Load, T, 1>(load, {{plane(k)}, {max_values[k]}}, k == 0,
                                first, count, row);
      }
    }
  }
}

template <typename T>
int64_t ElementKernels<T>::StreamMinima(const detail::Scan& scan,
                                        const detail::Chunk& chunk) {
  // Only boxes have doubles.
  if constexpr (kPagesPay && !std::is_same_v<T, double>) {
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
  if constexpr (kPagesPay) {
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
    const size_t words = (chunk.end - chunk.begin) / kWordObjects;
    for (size_t q = 0; q < chunk.query_count; ++q) {
      RangeByAxis<kFirst, T>(scan, ChunkOf(scan, chunk, q, 0, words));
    }
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
HWY_INLINE void PrefetchMaxima(const detail::Scan& scan, size_t first,
                               uint64_t nonzero) {
  constexpr size_t kFew = 16;
  constexpr size_t kLine = 64 / sizeof(T);
  if (hwy::PopCount(nonzero) > kFew) return;
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    const size_t i = first + w * kWordObjects;
    for (size_t line = 0; line < kWordObjects; line += kLine) {
      for (size_t k = 0; k < kAxes; ++k) {
        kernels::Prefetch(scan.Plane<T>(kAxes + k) + i + line);
      }
    }
  }
}

// Tests the maxima of the nonzero words of a tile, which are in `row`. If many
// words are nonzero, it tests only the groups of objects that have a survivor,
// unless most groups have one.
//
// For octahedra of 10 % of the world's side, groups of 16 take 0.8 of the time
// of whole words, and for octahedra of 3 % 1.02 of it (L1 and L2 on Zen 5). A
// word of quantized bounds is only one or two vectors, so it has no groups.
template <class D, typename T, class Load, size_t... kPlane>
HWY_NOINLINE void TestMaxima(D d, std::index_sequence<kPlane...>, Load load,
                             const detail::Scan& scan, const T* values,
                             size_t first, uint64_t nonzero, size_t words,
                             uint64_t* HWY_RESTRICT row) {
  const T* planes[] = {scan.Plane<T>(sizeof...(kPlane) + kPlane) + first...};
  // A local copy, because the compiler would load values behind a pointer again
  // after every store of a word. No vectors are passed to a lambda: a lambda
  // that is not inlined would leave the upper halves of registers in use, which
  // makes SSE4 code three times as slow.
  const T compared[] = {values[kPlane]...};
  if constexpr (std::is_floating_point_v<T> && kWordGroups > 1) {
    uint64_t groups[kTileWords * kWordGroups / 64];
    if (4 * hwy::PopCount(nonzero) > words &&
        2 * NonzeroGroups<kGroupObjects>(row, words, groups) <=
            words * kWordGroups) {
      VisitGroups<kGroupObjects>(groups, words, row, [&](size_t i) HWY_ATTR {
        return KeptBits<0, kGroupObjects>(d, load, planes, i,
                                          hn::Set(d, compared[kPlane])...);
      });
      return;
    }
  }
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    row[w] &= KeptBits<0>(d, load, planes, w * kWordObjects,
                          hn::Set(d, compared[kPlane])...);
  }
}

// Which words of a tile are nonzero, for each query of a chunk.
struct WordTile {
  size_t word;
  size_t words;
  uint64_t nonzero[detail::kMostQueries];
};

template <size_t kAxes, typename T>
HWY_INLINE void FinishTile(const detail::Scan& scan, const detail::Chunk& chunk,
                           const WordTile& tile) {
  for (size_t q = 0; q < chunk.query_count; ++q) {
    if (tile.nonzero[q] == 0) continue;
    WithLoad<T>(scan, chunk.begin, [&](auto load) HWY_ATTR {
      WithVectors<T>(scan, [&](auto d) HWY_ATTR {
        TestMaxima(
            d, std::make_index_sequence<kAxes>(), load, scan,
            static_cast<const T*>(chunk.queries) + q * scan.type->plane_count,
            chunk.begin + tile.word * kWordObjects, tile.nonzero[q], tile.words,
            chunk.rows + q * chunk.stride + tile.word);
      });
    });
  }
}

template <size_t kAxes, typename T>
int64_t BySimplex(const detail::Scan& scan, const detail::Chunk& chunk) {
  const size_t words = (chunk.end - chunk.begin) / kWordObjects;
  WordTile tiles[2];
  size_t turn = 0;
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const size_t count = HWY_MIN(kTileWords, words - begin);
    const detail::Chunk tile_chunk =
        ChunkFrom(chunk, begin, chunk.begin + (begin + count) * kWordObjects);
    if (scan.is_streaming) {
      scan.kernels->run[detail::kMinimaStreaming](scan, tile_chunk);
    } else {
      Flat<kAxes, 0, T>(scan, tile_chunk);
    }
    WordTile& tile = tiles[turn];
    tile.word = begin;
    tile.words = count;
    for (size_t q = 0; q < chunk.query_count; ++q) {
      tile.nonzero[q] = NonzeroWords(tile_chunk.rows + q * chunk.stride, count);
      if (scan.is_streaming) {
        PrefetchMaxima<kAxes, T>(scan, tile_chunk.begin, tile.nonzero[q]);
      }
    }
    turn ^= 1;
    if (begin != 0) FinishTile<kAxes, T>(scan, chunk, tiles[turn]);
  }
  if (words != 0) FinishTile<kAxes, T>(scan, chunk, tiles[turn ^ 1]);
  return FinishChunk(scan, chunk, detail::kAll);
}

// ---- kAuto: the survivors of one stretch of the world decide how the next
// stretch is tested.

// How many planes all objects are tested on, in ascending order.
enum class Step { kOneAxis, kHalf, kEveryPlane };

// Fewer words of one query are tested flat, because the branches of stages cost
// more than they save. For several queries the limit is half as high, because
// each query begins with the step that the query before it ended with. In plain
// code one word by axis takes half of the time of a flat word (a box on Zen 3).
inline constexpr size_t kFewWords =
    kHasVectors ? 2 * HWY_MIN(size_t{8}, hn::MaxLanes(OneTag<float>())) : 1;

// Which step is next, and for how many words.
class Ladder {
 public:
  // `bytes` is the size of all planes that the call reads, one after another.
  Ladder(bool is_box, size_t bytes)
      : is_box_(is_box),
        most_of_axis_(bytes > kMemoryBytes ? 1
                      : is_box             ? 3
                                           : 2) {}

  Step step() const { return step_; }

  // The number of words of the next stretch, if `left` words of the chunk are
  // left. No stretch is much shorter than the stretch before it. Fewer than
  // ShortWords() words are one stretch, because each stretch costs about 25 ns.
  size_t Words(size_t left) const {
    return left < HWY_MAX(2 * words_, ShortWords(is_box_)) ? left : words_;
  }

  static constexpr size_t ShortWords(bool is_box) {
    return is_box ? kTileWords : kTileWords / 2;
  }

  // Chooses the next step after a stretch. After a scan by axis, `left` counts
  // the groups that have a survivor of the first planes. After the other scans,
  // it counts the nonzero words of the last tile.
  void Learn(Left left) {
    Step next = step_;
    if (step_ == Step::kOneAxis && 8 * left.some > most_of_axis_ * left.all) {
      next = is_box_ && left.IsAlmostAll() ? Step::kEveryPlane : Step::kHalf;
      patience_ = kPatience;
    } else if (step_ == Step::kHalf &&
               (is_box_ ? left.IsMany() : 4 * left.some > 3 * left.all)) {
      next = Step::kEveryPlane;
    } else if (step_ == Step::kHalf && 64 * left.some <= left.all) {
      if (patience_ == 0) next = Step::kOneAxis;
      patience_ -= patience_ != 0 ? 1 : 0;
    } else if (step_ == Step::kEveryPlane &&
               (is_box_ ? 4 : 2) * left.some < left.all) {
      next = Step::kHalf;
    }
    const size_t longer = HWY_MIN(2 * words_, kMostWords);
    words_ = next != step_ ? kTileWords : HWY_MAX(longer, kTileWords);
    step_ = next;
  }

 private:
  static constexpr size_t kFirstWords = 8;
  static constexpr size_t kMostWords = 16 * kTileWords;
  // The number of stretches before kOneAxis is tried again, after it was too
  // slow.
  static constexpr size_t kPatience = 16;

  // Beyond the caches, each group is a cache line that no prefetcher expects,
  // so scans by axis are faster only if fewer groups are left.
  static constexpr size_t kMemoryBytes = size_t{16} << 20;

  bool is_box_;
  size_t most_of_axis_;  // of 8 groups
  // A scan by one axis says most about the world. The first stretch is short,
  // because nothing is known yet.
  Step step_ = Step::kOneAxis;
  size_t words_ = kFirstWords;
  size_t patience_ = 0;
};

// The words of the last tile of a chunk that are not zero.
HWY_INLINE Left NonzeroOfLastTile(const detail::Chunk& chunk) {
  const size_t words = (chunk.end - chunk.begin) / kWordObjects;
  const size_t count = HWY_MIN(words, kTileWords);
  const uint64_t nonzero = NonzeroWords(chunk.rows + (words - count), count);
  return {hwy::PopCount(nonzero), count};
}

// Tests whole words of one query, and returns what Ladder::Learn() needs.
template <typename T>
HWY_INLINE Left TestStretch(const detail::Scan& scan,
                            const detail::Chunk& chunk, Step step) {
  if (step == Step::kOneAxis) return RangeByAxis<1, T>(scan, chunk);
  detail::ScanKernel kernel =
      scan.is_streaming ? detail::kAllStreaming : detail::kAll;
  if (step == Step::kHalf) {
    if (scan.type->kind == detail::PlaneLayout::kAabb) {
      // Half of the axes, rounded up.
      return scan.type->axes > 2 ? RangeByAxis<2, T>(scan, chunk)
                                 : RangeByAxis<1, T>(scan, chunk);
    }
    kernel = detail::kBySimplex;
  }
  scan.kernels->run[kernel](scan, chunk);
  return NonzeroOfLastTile(chunk);
}

template <typename T>
int64_t ElementKernels<T>::Adaptive(const detail::Scan& scan,
                                    const detail::Chunk& chunk) {
  if constexpr (!std::is_floating_point_v<T>) {
    return scan.kernels->run[detail::kAll](scan, chunk);
  } else if constexpr (!kHasVectors) {
    return ByAxis(scan, chunk);
  } else {
    // The kernels of several queries do a part of the work once for all of
    // them. This pays for octahedra, and with AVX-512 also for boxes.
    const bool is_box = scan.type->kind == detail::PlaneLayout::kAabb;
    if (chunk.query_count > 1 && (HALFSPACE_MASKED_COMPARES || !is_box)) {
      const detail::ScanKernel kernel =
          is_box ? detail::kAll : detail::kBySimplex;
      return scan.kernels->run[kernel](scan, chunk);
    }
    const size_t words = (chunk.end - chunk.begin) / kWordObjects;
    // If there are few octahedra, and few of them are near the query,
    // kBySimplex takes 0.6 to 0.9 of the time of a flat scan. Its worst case is
    // better than that of kByAxis: 1.3 times the time of a flat scan (objects
    // of 0.1 %) instead of 1.6 (objects of 10 %).
    if (!is_box && words < Ladder::ShortWords(is_box)) {
      return scan.kernels->run[detail::kBySimplex](scan, chunk);
    }
    if (words < (chunk.query_count > 1 ? kFewWords / 2 : kFewWords)) {
      return scan.kernels->run[detail::kAll](scan, chunk);
    }
    // Several queries are tested on a tile in the first-level cache.
    const size_t objects =
        scan.query_count == 1 ? scan.end - scan.begin : words * kWordObjects;
    Ladder ladder(is_box, objects * scan.type->record_bytes);
    for (size_t q = 0; q < chunk.query_count; ++q) {
      for (size_t begin = 0; begin < words;) {
        const size_t count = ladder.Words(words - begin);
        ladder.Learn(TestStretch<T>(scan, ChunkOf(scan, chunk, q, begin, count),
                                    ladder.step()));
        begin += count;
      }
    }
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
    constexpr size_t kMostWords = !kHasVectors               ? 0
                                  : std::is_same_v<T, float> ? kMostFewWords
                                                             : kFewWords - 1;
    kernels.few_objects = (kMostWords + 1) * kWordObjects - 1;
    kernels.few_octahedra =
        kHasVectors ? 48 * HWY_MIN(size_t{8}, hn::MaxLanes(OneTag<float>())) - 1
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
