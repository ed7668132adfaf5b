// Scans that test some planes of many objects before others: page by page where
// planes are streamed from memory, and in stages, each of which tests only
// objects that survived the stage before.
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

// 4096 objects: one word has a bit for each of their words, and what a stage
// keeps for the next one stays in L1.
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

// Objects from word `first` of a part on, up to object `end`. Field by field: a
// copy in vectors waits for the stores of the fields.
HWY_INLINE detail::Part PartFrom(const detail::Part& part, size_t first,
                                 size_t end) {
  return {.first_query = part.first_query,
          .query_count = part.query_count,
          .queries = part.queries,
          .begin = part.begin + first * kWordObjects,
          .end = end,
          .rows = part.rows + first,
          .stride = part.stride};
}

// Tests the objects after the last whole word of a part, on all planes at once.
HWY_INLINE int64_t FinishPart(const detail::Scan& scan,
                              const detail::Part& part, detail::Way way) {
  const size_t words = (part.end - part.begin) / kWordObjects;
  if (part.begin + words * kWordObjects == part.end) return HWY_TARGET;
  return scan.kernels->run[way](scan, PartFrom(part, words, part.end));
}

// ---- Streaming: one query over planes out of the caches.

// Streaming is used where it was measured to pay. Plain code packs bits one by
// one, again for every two planes, and took more than twice as long.
inline constexpr bool kPagesPay =
    HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128;

// A page of each plane; for quantized bounds of one byte, half a page is 5 %
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

// Tests a page. Words of the first planes are stored, words of later ones are
// ANDed to those that are there.
template <size_t kMins, class Load, typename T, size_t kPlanes>
HWY_INLINE void TestPage(Load load, const PlaneGroup<T, kPlanes>& group,
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

// Tests a page of two planes, then a page of two others. The two are those of
// an axis, or, without maxima, those of two axes, with the last one alone if
// their number is odd. Prefetchers follow two streams and not eight: an
// octahedron in L3 takes 0.34 ns instead of 0.48 on Zen 4 (AVX2), a box 0.25
// instead of 0.28. Prefetching the begin of the next pages gains 3 %;
// prefetching more of them was slower at any distance.
template <bool kWithMaxima, typename T, class Load>
HWY_INLINE void StreamPages(Load load, const detail::Scan& scan,
                            const detail::Part& part) {
  const size_t axes = scan.type->axes;
  const T* min_values = static_cast<const T*>(part.queries);
  const T* max_values = min_values + scan.type->first_max;
  const auto plane = [&](size_t p) { return scan.Plane<T>(p); };
  // The second plane of a pair that begins with plane k.
  const auto partner = [&](size_t k) {
    return plane(kWithMaxima ? axes + k : HWY_MIN(k + 1, axes - 1));
  };
  constexpr size_t kStep = kWithMaxima ? 1 : 2;
  const size_t words = (part.end - part.begin) / kWordObjects;
  for (size_t w = 0; w < words; w += kPageWords<T>) {
    const size_t first = part.begin + w * kWordObjects;
    const size_t count = HWY_MIN(kPageWords<T>, words - w);
    uint64_t* row = part.rows + w;
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
                                        const detail::Part& part) {
  if constexpr (kPagesPay) {
    WithLoad<T>(scan, part.begin, [&](auto load) HWY_ATTR {
      StreamPages<false, T>(load, scan, part);
    });
    return FinishPart(scan, part, detail::kMinima);
  } else {
    return scan.kernels->run[detail::kMinima](scan, part);
  }
}

template <typename T>
int64_t ElementKernels<T>::StreamAll(const detail::Scan& scan,
                                     const detail::Part& part) {
  if constexpr (kPagesPay) {
    WithLoad<T>(scan, part.begin, [&](auto load) HWY_ATTR {
      StreamPages<true, T>(load, scan, part);
    });
    return FinishPart(scan, part, detail::kAll);
  } else {
    return scan.kernels->run[detail::kAll](scan, part);
  }
}

// ---- By axis: each stage leaves many groups of objects, which are listed.

// The groups of a tile that still have a survivor, by the offset of their first
// object.
struct GroupList {
  static constexpr size_t kSmallestGroup = 16;

  uint16_t groups[kTileWords * kWordObjects / kSmallestGroup];

  // Appends a group to a list of `count` if it has a survivor, and returns the
  // new count; the group's bits of `survivors` begin at the lowest. There is no
  // branch, because which groups survive cannot be predicted, and a
  // mispredicted branch costs more than the test of a whole vector (measured: a
  // staged box took three times as long as a flat one).
  template <size_t kGroup>
  HWY_INLINE size_t AppendIfLeft(size_t count, size_t offset,
                                 uint64_t survivors) {
    static_assert(kGroup >= kSmallestGroup, "the list would be too short");
    groups[count] = static_cast<uint16_t>(offset);
    return count + ((survivors & kLowBits<kGroup>) != 0);
  }
};

// Tests both planes of an axis for all objects of a tile, then those of the
// next axis for the groups that still have a survivor, and so on.
template <typename T>
HWY_INLINE void TileByAxis(const detail::Scan& scan, const T* values,
                           size_t first, size_t words,
                           uint64_t* HWY_RESTRICT row) {
  const OneTag<T> d;
#if HWY_HAVE_SCALABLE
  // A group must hold a whole vector, whose length is not known here.
  constexpr size_t kGroup = kWordObjects;
#else
  constexpr size_t kGroup =
      HWY_MAX(GroupList::kSmallestGroup, hn::MaxLanes(OneTag<T>()));
#endif
  GroupList list;
  size_t left = 0;
  for (size_t k = 0; k < scan.type->axes; ++k) {
    const T* planes[] = {scan.Plane<T>(k) + first,
                         scan.Plane<T>(scan.type->axes + k) + first};
    const auto max = hn::Set(d, values[scan.type->first_max + k]);
    const auto min = hn::Set(d, values[k]);
    if (k == 0) {
      for (size_t w = 0; w < words; ++w) {
        const uint64_t kept =
            KeptBits<1>(d, LoadAll(), planes, w * kWordObjects, max, min);
        row[w] = kept;
        for (size_t g = 0; g < kWordObjects; g += kGroup) {
          left = list.template AppendIfLeft<kGroup>(left, w * kWordObjects + g,
                                                    kept >> g);
        }
      }
      continue;
    }
    const size_t count = left;
    left = 0;
    for (size_t j = 0; j < count; ++j) {
      const size_t offset = list.groups[j];
      const size_t shift = offset % kWordObjects;
      const uint64_t rejected =
          KeptBits<1, kGroup>(d, LoadAll(), planes, offset, max, min) ^
          kLowBits<kGroup>;
      const uint64_t word = row[offset / kWordObjects] & ~(rejected << shift);
      row[offset / kWordObjects] = word;
      left = list.template AppendIfLeft<kGroup>(left, offset, word >> shift);
    }
  }
}

template <typename T>
int64_t ElementKernels<T>::ByAxis(const detail::Scan& scan,
                                  const detail::Part& part) {
  // Quantized bounds have no stages by axis.
  if constexpr (std::is_floating_point_v<T>) {
    const size_t words = (part.end - part.begin) / kWordObjects;
    for (size_t q = 0; q < part.query_count; ++q) {
      const T* values =
          static_cast<const T*>(part.queries) + q * scan.type->plane_count;
      for (size_t begin = 0; begin < words; begin += kTileWords) {
        TileByAxis(scan, values, part.begin + begin * kWordObjects,
                   HWY_MIN(kTileWords, words - begin),
                   part.rows + q * part.stride + begin);
      }
    }
    return FinishPart(scan, part, detail::kAll);
  } else {
    return scan.kernels->run[detail::kAll](scan, part);
  }
}

// ---- By simplex: an octahedron's minima, then its maxima for the nonzero
// words, which are few.

// Prefetches the maxima of the nonzero words of a tile, before the minima of
// the next tile are tested: out of the caches each of them is a miss. Where
// many words are nonzero, they are read in order, and the hardware prefetches
// them.
//
// The lines of the planes alternate, so that the four lines of one plane do not
// look like the begin of a stream to the hardware.
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

// Tests the maxima of the nonzero words of a tile. `row` has its words.
template <typename T, class Load, size_t... kPlane>
HWY_NOINLINE void TestMaxima(std::index_sequence<kPlane...>, Load load,
                             const detail::Scan& scan, const T* values,
                             size_t first, uint64_t nonzero, uint64_t* row) {
  const OneTag<T> d;
  const T* planes[] = {scan.Plane<T>(sizeof...(kPlane) + kPlane)...};
  for (; nonzero != 0; nonzero &= nonzero - 1) {
    const size_t w = hwy::Num0BitsBelowLS1Bit_Nonzero64(nonzero);
    row[w] &= KeptBits<0>(d, load, planes, first + w * kWordObjects,
                          hn::Set(d, values[kPlane])...);
  }
}

// Which words of a tile are nonzero, for each query of a part.
struct WordTile {
  size_t word;
  uint64_t nonzero[detail::kMostQueries];
};

template <size_t kAxes, typename T>
HWY_INLINE void FinishTile(const detail::Scan& scan, const detail::Part& part,
                           const WordTile& tile) {
  for (size_t q = 0; q < part.query_count; ++q) {
    if (tile.nonzero[q] == 0) continue;
    WithLoad<T>(scan, part.begin, [&](auto load) HWY_ATTR {
      TestMaxima<T>(
          std::make_index_sequence<kAxes>(), load, scan,
          static_cast<const T*>(part.queries) + q * scan.type->plane_count,
          part.begin + tile.word * kWordObjects, tile.nonzero[q],
          part.rows + q * part.stride + tile.word);
    });
  }
}

template <size_t kAxes, typename T>
int64_t BySimplex(const detail::Scan& scan, const detail::Part& part) {
  const size_t words = (part.end - part.begin) / kWordObjects;
  WordTile tiles[2];
  size_t turn = 0;
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const size_t count = HWY_MIN(kTileWords, words - begin);
    const detail::Part tile_part =
        PartFrom(part, begin, part.begin + (begin + count) * kWordObjects);
    if (scan.is_streaming) {
      scan.kernels->run[detail::kMinimaStreaming](scan, tile_part);
    } else {
      Flat<kAxes, 0, T>(scan, tile_part);
    }
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

// ---- The table of a target.

template <size_t kAxes, typename T>
constexpr detail::TargetKernels MakeKernels() {
  detail::TargetKernels kernels{};
  kernels.nonzero_words = &FindNonzeroWords;
  kernels.count_bits = &CountBits;
  kernels.run[detail::kAll] = &Flat<kAxes, kAxes, T>;
  kernels.word[detail::kAll] = &FlatTail<kAxes, kAxes, T>;
  kernels.run[detail::kAllStreaming] = &ElementKernels<T>::StreamAll;
  if constexpr (std::is_floating_point_v<T>) {
    kernels.run[detail::kByAxis] = &ElementKernels<T>::ByAxis;
  }
  if constexpr (kAxes > 2) {
    kernels.run[detail::kMinima] = &Flat<kAxes, 0, T>;
    kernels.word[detail::kMinima] = &FlatTail<kAxes, 0, T>;
    kernels.run[detail::kMinimaStreaming] = &ElementKernels<T>::StreamMinima;
    kernels.run[detail::kBySimplex] = &BySimplex<kAxes, T>;
  }
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_STAGES_INL_H_
