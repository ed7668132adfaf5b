// Scans that look at some planes of many objects before they look at others:
// page by page where planes come from memory, and in stages, of which each sees
// only the objects that the one before has left.
#if defined(HALFSPACE_KERNELS_SCAN_STAGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
#undef HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/prefetch.h"
#include "kernels/scan/flat-inl.h"
#include "kernels/scan/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// 4096 objects: the bits of one word say which of their words are left, and
// what a stage keeps for the next one stays in L1.
inline constexpr size_t kTileWords = 64;

// The kernels that are the same for any number of axes: compiled once for each
// type of element.
template <typename T>
struct ElementKernels {
  static int64_t StreamMinima(const detail::Scan& scan,
                              const detail::Part& part);
  static int64_t StreamAll(const detail::Scan& scan, const detail::Part& part);
  static int64_t ByAxis(const detail::Scan& scan, const detail::Part& part);
};

// What follows the last whole word of a part, tested on all planes at once.
HWY_INLINE int64_t FinishPart(const detail::Scan& scan,
                              const detail::Part& part, detail::Way way) {
  const size_t words = (part.end - part.begin) / kWordObjects;
  detail::Part rest = part;
  rest.begin += words * kWordObjects;
  rest.rows += words;
  if (rest.begin == rest.end) return HWY_TARGET;
  return scan.kernels->run[way](scan, rest);
}

// ---- Streaming: one query over planes out of the caches.

// Where it was measured. Plain code packs bits one by one, for each two planes
// anew, and took more than twice as long.
inline constexpr bool kPagesPay = HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR;

// A page of each plane; of codes half a page is 5 % faster.
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

template <typename T>
HWY_INLINE void PrefetchWord(const T* plane, size_t first) {
  for (size_t i = 0; i < kWordObjects; i += 64 / sizeof(T)) {
    kernels::Prefetch(plane + first + i);
  }
}

// A page of words, of which those that are not the first are ANDed to what the
// planes before have kept.
template <size_t kMins, typename T, size_t kPlanes>
HWY_NOINLINE void TestPage(const PlaneGroup<T, kPlanes>& group, bool is_first,
                           size_t first, size_t words, uint64_t* row) {
  const OneTag<T> d;
  const auto test = [&](size_t w) HWY_ATTR {
    if constexpr (kPlanes == 1) {
      return KeptBits<kMins, kWordObjects, Pack::kInstructions>(
          d, LoadAll(), group.planes, first + w * kWordObjects,
          hn::Set(d, group.values[0]));
    } else {
      return KeptBits<kMins, kWordObjects, Pack::kInstructions>(
          d, LoadAll(), group.planes, first + w * kWordObjects,
          hn::Set(d, group.values[0]), hn::Set(d, group.values[1]));
    }
  };
  if (is_first) {
    for (size_t w = 0; w < words; ++w) row[w] = test(w);
  } else {
    for (size_t w = 0; w < words; ++w) row[w] &= test(w);
  }
}

// Plane p and, if there is one, its partner: a minimum's maximum, or, without
// maxima, the next minimum.
struct PlanePair {
  size_t first;
  size_t second;
  bool is_pair;
};
HWY_INLINE PlanePair PairOf(const detail::Scan& scan, size_t pair,
                            bool with_maxima) {
  if (with_maxima) return {pair, scan.axes + pair, true};
  return {2 * pair, 2 * pair + 1, 2 * pair + 1 < scan.axes};
}

// A page of two planes after a page of two others. Prefetchers follow two
// streams, and not eight: an octahedron in L3 takes 0.34 ns instead of 0.48 on
// Zen 4 (AVX2), a box 0.25 instead of 0.28. To ask for more than where the next
// pages begin, which gains 3 %, was slower at any distance.
template <typename T>
HWY_INLINE void StreamPages(const detail::Scan& scan, const detail::Part& part,
                            bool with_maxima) {
  const T* values = static_cast<const T*>(part.queries);
  const auto plane = [&](size_t p) {
    return static_cast<const T*>(scan.planes[p]);
  };
  const size_t pairs = with_maxima ? scan.axes : (scan.axes + 1) / 2;
  const size_t words = (part.end - part.begin) / kWordObjects;
  for (size_t w = 0; w < words; w += kPageWords<T>) {
    const size_t first = part.begin + w * kWordObjects;
    const size_t count = HWY_MIN(kPageWords<T>, words - w);
    uint64_t* row = part.rows + w;
    for (size_t p = 0; p < pairs; ++p) {
      const bool is_last = p + 1 == pairs;
      const size_t next_first = first + (is_last ? count * kWordObjects : 0);
      if (!is_last || w + count < words) {
        const PlanePair next = PairOf(scan, is_last ? 0 : p + 1, with_maxima);
        PrefetchWord(plane(next.first), next_first);
        if (next.is_pair) PrefetchWord(plane(next.second), next_first);
      }
      const PlanePair pair = PairOf(scan, p, with_maxima);
      const T max = values[scan.first_max + pair.first];
      if (with_maxima) {
        TestPage<1, T, 2>(
            {{plane(pair.first), plane(pair.second)}, {max, values[p]}}, p == 0,
            first, count, row);
      } else if (pair.is_pair) {
        TestPage<2, T, 2>({{plane(pair.first), plane(pair.second)},
                           {max, values[scan.first_max + pair.second]}},
                          p == 0, first, count, row);
      } else {
        TestPage<1, T, 1>({{plane(pair.first)}, {max}}, p == 0, first, count,
                          row);
      }
    }
  }
}

template <typename T>
int64_t ElementKernels<T>::StreamMinima(const detail::Scan& scan,
                                        const detail::Part& part) {
  StreamPages<T>(scan, part, false);
  return FinishPart(scan, part, detail::kMinima);
}

template <typename T>
int64_t ElementKernels<T>::StreamAll(const detail::Scan& scan,
                                     const detail::Part& part) {
  StreamPages<T>(scan, part, true);
  return FinishPart(scan, part, detail::kAll);
}

// ---- By axis: stages that leave many groups of objects, kept in a list.

// The groups of a tile that still have an object, by the offset of their first,
// and the survivors so far.
struct GroupTile {
  static constexpr size_t kSmallestGroup = 16;

  uint64_t* words;
  uint16_t groups[kTileWords * kWordObjects / kSmallestGroup];
  size_t count;

  // Keeps a group on the list iff one of its objects is left. No branch: which
  // groups survive cannot be predicted, and a mispredicted branch costs more
  // than a whole vector's test (measured: 3 times slower than flat).
  template <size_t kGroup>
  HWY_INLINE void AppendIfLeft(size_t offset) {
    static_assert(kGroup >= kSmallestGroup, "the list would be too short");
    const uint64_t word = words[offset / kWordObjects];
    groups[count] = static_cast<uint16_t>(offset);
    count += ((word >> (offset % kWordObjects)) & kLowBits<kGroup>) != 0;
  }
};

// Both planes of an axis, then those of the next axis for the groups that are
// left.
template <typename T>
int64_t ElementKernels<T>::ByAxis(const detail::Scan& scan,
                                  const detail::Part& part) {
  const OneTag<T> d;
#if HWY_HAVE_SCALABLE
  // A group must hold a whole vector, whose length is not known here.
  constexpr size_t kGroup = kWordObjects;
#else
  constexpr size_t kGroup =
      HWY_MAX(GroupTile::kSmallestGroup, hn::MaxLanes(OneTag<T>()));
#endif
  const size_t words = (part.end - part.begin) / kWordObjects;
  for (size_t q = 0; q < part.query_count; ++q) {
    const T* values =
        static_cast<const T*>(part.queries) + q * scan.plane_count;
    for (size_t begin = 0; begin < words; begin += kTileWords) {
      const size_t tile_words = HWY_MIN(kTileWords, words - begin);
      const size_t first = part.begin + begin * kWordObjects;
      GroupTile tile;
      tile.count = 0;
      tile.words = part.rows + q * part.stride + begin;
      for (size_t k = 0; k < scan.axes; ++k) {
        const T* planes[] = {static_cast<const T*>(scan.planes[k]),
                             static_cast<const T*>(scan.planes[scan.axes + k])};
        const auto max = hn::Set(d, values[scan.first_max + k]);
        const auto min = hn::Set(d, values[k]);
        const size_t count = tile.count;
        tile.count = 0;
        if (k == 0) {
          for (size_t w = 0; w < tile_words; ++w) {
            tile.words[w] = KeptBits<1>(d, LoadAll(), planes,
                                        first + w * kWordObjects, max, min);
            for (size_t g = 0; g < kWordObjects; g += kGroup) {
              tile.template AppendIfLeft<kGroup>(w * kWordObjects + g);
            }
          }
          continue;
        }
        for (size_t j = 0; j < count; ++j) {
          const size_t offset = tile.groups[j];
          const size_t shift = offset % kWordObjects;
          const uint64_t rejected =
              KeptBits<1, kGroup>(d, LoadAll(), planes, first + offset, max,
                                  min) ^
              kLowBits<kGroup>;
          tile.words[offset / kWordObjects] &= ~(rejected << shift);
          tile.template AppendIfLeft<kGroup>(offset);
        }
      }
    }
  }
  return FinishPart(scan, part, detail::kAll);
}

// ---- By simplex: an octahedron's minima, and then, of the few words that are
// left, its maxima.

// The maxima of the nonzero words of a tile are on their way while the next
// tile's minima are tested: out of the caches each of them is a miss. Where
// many words are left they come in order, and the hardware sees that.
template <size_t kAxes, typename T>
HWY_INLINE void PrefetchMaxima(const detail::Scan& scan, size_t first,
                               uint64_t nonzero) {
  constexpr size_t kFew = 16;
  if (hwy::PopCount(nonzero) > kFew) return;
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    for (size_t k = 0; k < kAxes; ++k) {
      PrefetchWord(static_cast<const T*>(scan.planes[kAxes + k]),
                   first + w * kWordObjects);
    }
  }
}

// Tests the maxima of the nonzero words of a tile. `row` has its words.
template <typename T, size_t... kPlane>
HWY_NOINLINE void TestMaxima(std::index_sequence<kPlane...>,
                             const detail::Scan& scan, const T* values,
                             size_t first, uint64_t nonzero, uint64_t* row) {
  const OneTag<T> d;
  const T* planes[] = {
      static_cast<const T*>(scan.planes[sizeof...(kPlane) + kPlane])...};
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    row[w] &= KeptBits<0>(d, LoadAll(), planes, first + w * kWordObjects,
                          hn::Set(d, values[kPlane])...);
  }
}

// Of each query of a part, which words of a tile have survivors.
struct WordTile {
  size_t word;
  uint64_t nonzero[detail::kMostQueries];
};

template <size_t kAxes, typename T>
HWY_INLINE void FinishTile(const detail::Scan& scan, const detail::Part& part,
                           const WordTile& tile) {
  for (size_t q = 0; q < part.query_count; ++q) {
    if (tile.nonzero[q] == 0) continue;
    TestMaxima<T>(std::make_index_sequence<kAxes>(), scan,
                  static_cast<const T*>(part.queries) + q * scan.plane_count,
                  part.begin + tile.word * kWordObjects, tile.nonzero[q],
                  part.rows + q * part.stride + tile.word);
  }
}

template <size_t kAxes, typename T>
int64_t BySimplex(const detail::Scan& scan, const detail::Part& part) {
  const detail::Way minima =
      scan.is_streaming ? detail::kMinimaStreaming : detail::kMinima;
  const size_t words = (part.end - part.begin) / kWordObjects;
  WordTile tiles[2];
  size_t turn = 0;
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const size_t count = HWY_MIN(kTileWords, words - begin);
    detail::Part tile_part = part;
    tile_part.begin += begin * kWordObjects;
    tile_part.end = tile_part.begin + count * kWordObjects;
    tile_part.rows += begin;
    scan.kernels->run[minima](scan, tile_part);
    WordTile& tile = tiles[turn];
    tile.word = begin;
    for (size_t q = 0; q < part.query_count; ++q) {
      tile.nonzero[q] = NonzeroWords(tile_part.rows + q * part.stride, count);
      if (scan.is_streaming) {
        PrefetchMaxima<kAxes, T>(scan, tile_part.begin, tile.nonzero[q]);
      }
    }
    turn ^= 1;
    if (begin != 0) FinishTile<kAxes, T>(scan, part, tiles[turn]);
  }
  if (words != 0) FinishTile<kAxes, T>(scan, part, tiles[turn ^ 1]);
  return FinishPart(scan, part, detail::kAll);
}

// ---- What a target has to offer.

template <size_t kAxes, typename T>
constexpr detail::TargetKernels MakeKernels() {
  detail::TargetKernels kernels{};
  kernels.nonzero_words = &FindNonzeroWords;
  kernels.count_bits = &CountBits;
  kernels.run[detail::kAll] = &Flat<kAxes, kAxes, T>;
  kernels.run[detail::kAllStreaming] = kernels.run[detail::kAll];
  if constexpr (kPagesPay) {
    kernels.run[detail::kAllStreaming] = &ElementKernels<T>::StreamAll;
  }
  if constexpr (std::is_floating_point_v<T>) {
    kernels.run[detail::kByAxis] = &ElementKernels<T>::ByAxis;
  }
  if constexpr (kAxes > 2) {
    kernels.run[detail::kMinima] = &Flat<kAxes, 0, T>;
    kernels.run[detail::kMinimaStreaming] = kernels.run[detail::kMinima];
    if constexpr (kPagesPay) {
      kernels.run[detail::kMinimaStreaming] = &ElementKernels<T>::StreamMinima;
    }
    kernels.run[detail::kBySimplex] = &BySimplex<kAxes, T>;
  }
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
