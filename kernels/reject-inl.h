// THE loop over words of 64 objects, flat or staged, with its tail. Shapes are
// data (planes.h), the lane type is a template parameter.
//
// Query planes travel as a parameter pack of vectors: an SVE vector cannot be
// an array element or a member.
#if defined(HALFSPACE_KERNELS_REJECT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_REJECT_INL_H_
#undef HALFSPACE_KERNELS_REJECT_INL_H_
#else
#define HALFSPACE_KERNELS_REJECT_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

#include "hwy/highway.h"
#include "kernels/mask_job.h"
#include "kernels/planes.h"
#include "kernels/together-inl.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Every plane of `words` whole words. `row` has the word of object `first`.
template <class Shape, class D, typename T, class... V>
HWY_INLINE void ScanWordsFlat(D d, const T* const* planes, size_t first,
                              size_t words, uint64_t* row, uint64_t flip,
                              V... query) {
  constexpr size_t kPlanes = Shape::kOrder.planes.size();
  for (size_t w = 0; w < words; ++w) {
    row[w] = BitsRejected<Shape, kWordObjects, 0, kPlanes>(
                 d, planes, first + w * kWordObjects, query...) ^
             flip;
  }
}

// The groups of a tile that are not yet all rejected, by offset of their first
// object, and the rejections so far.
struct Tile {
  // 4096 objects: the list and the words stay in L1, and the branches that end
  // the loops over them cost little per object.
  static constexpr size_t kWords = 64;
  static constexpr size_t kSmallestGroup = 16;

  uint64_t words[kWords];
  uint16_t live[kWords * kWordObjects / kSmallestGroup];
  size_t live_count = 0;

  // Keeps a group on the list iff one of its objects is left. No branch: which
  // groups survive cannot be predicted, and a mispredicted branch costs more
  // than a whole vector's test (measured: 3 times slower than flat).
  template <size_t kGroup>
  HWY_INLINE void AppendIfLive(size_t offset) {
    static_assert(kGroup >= kSmallestGroup, "the list would be too short");
    const uint64_t word = words[offset / kWordObjects];
    live[live_count] = static_cast<uint16_t>(offset);
    live_count += ((word >> (offset % kWordObjects)) & kLowBits<kGroup>) !=
                  kLowBits<kGroup>;
  }
};

// Stage kStage and those after it, for the live groups only.
template <class Shape, size_t kGroup, size_t kStage, class D, typename T,
          class... V>
HWY_INLINE void TestLiveGroups(D d, const T* const* planes, size_t first,
                               Tile& tile, V... query) {
  constexpr size_t kBegin = Shape::kOrder.stage_ends[kStage - 1];
  constexpr size_t kEnd = Shape::kOrder.stage_ends[kStage];
  constexpr bool kLast = kStage + 1 == Shape::kOrder.stage_ends.size();
  const size_t count = tile.live_count;
  tile.live_count = 0;
  for (size_t j = 0; j < count; ++j) {
    const size_t offset = tile.live[j];
    tile.words[offset / kWordObjects] |=
        BitsRejected<Shape, kGroup, kBegin, kEnd>(d, planes, first + offset,
                                                  query...)
        << (offset % kWordObjects);
    if constexpr (!kLast) tile.AppendIfLive<kGroup>(offset);
  }
  if constexpr (!kLast) {
    TestLiveGroups<Shape, kGroup, kStage + 1>(d, planes, first, tile, query...);
  }
}

// Stage after stage over a tile of words; a stage sees only the groups that the
// stages before it left.
template <class Shape, class D, typename T, class... V>
HWY_INLINE void ScanWordsStaged(D d, const T* const* planes, size_t first,
                                size_t words, uint64_t* row, uint64_t flip,
                                V... query) {
#if HWY_HAVE_SCALABLE
  // A group must hold a whole vector, whose length is not known here.
  constexpr size_t kGroup = kWordObjects;
#elif HALFSPACE_PAIRWISE_PACKING
  constexpr size_t kGroup = Shape::kGroup;
#else
  constexpr size_t kGroup = HWY_MAX(Shape::kGroup, hn::MaxLanes(D()));
#endif
  Tile tile;
  for (size_t begin = 0; begin < words; begin += Tile::kWords) {
    const size_t tile_words = HWY_MIN(Tile::kWords, words - begin);
    const size_t tile_first = first + begin * kWordObjects;
    tile.live_count = 0;
    for (size_t w = 0; w < tile_words; ++w) {
      tile.words[w] =
          BitsRejected<Shape, kWordObjects, 0, Shape::kOrder.stage_ends[0]>(
              d, planes, tile_first + w * kWordObjects, query...);
      for (size_t g = 0; g < kWordObjects; g += kGroup) {
        tile.AppendIfLive<kGroup>(w * kWordObjects + g);
      }
    }
    TestLiveGroups<Shape, kGroup, 1>(d, planes, tile_first, tile, query...);
    for (size_t w = 0; w < tile_words; ++w) {
      row[begin + w] = tile.words[w] ^ flip;
    }
  }
}

// One query.
template <class Shape, typename T, size_t... kPlane>
HWY_INLINE void ScanOne(std::index_sequence<kPlane...>, const T* const* planes,
                        const T* values, const kernels::MaskJob& job,
                        uint64_t* row) {
  const WordTag<T> d;
  const size_t words = (job.end - job.begin) / kWordObjects;
  if constexpr (Shape::kOrder.stage_ends.size() == 1) {
    ScanWordsFlat<Shape>(
        d, planes, job.begin, words, row, job.flip,
        hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
  } else {
    ScanWordsStaged<Shape>(
        d, planes, job.begin, words, row, job.flip,
        hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...);
  }
  const size_t i = job.begin + words * kWordObjects;
  if (i < job.end) {
    row[words] =
        TailRejected<Shape>(
            d, planes, i, job.end - i,
            hn::Set(d, values[kernels::kQueryIndex<Shape, kPlane>])...) ^
        job.flip;
  }
}

template <class Shape, typename T, size_t... kPlane>
HWY_INLINE void ScanAll(std::index_sequence<kPlane...> all_planes,
                        const kernels::MaskJob& job) {
  constexpr size_t kPlanes = sizeof...(kPlane);
  // A local copy: the stores of words must not make the compiler reload them.
  const T* planes[] = {static_cast<const T*>(job.planes[kPlane])...};
  const T* values = static_cast<const T*>(job.queries);
  uint64_t* row = job.rows;
  size_t left = job.query_count;
  if constexpr (Shape::kOrder.stage_ends.size() == 1) {
    constexpr size_t kTogether = kQueriesTogether<kPlanes>;
    if constexpr (kTogether > 1) {
      for (; left >= kTogether; left -= kTogether) {
        ScanTogether<Shape, kTogether, T>(planes, values, job, row);
        values += kTogether * kPlanes;
        row += kTogether * job.stride;
      }
    }
  }
  for (; left != 0; --left) {
    ScanOne<Shape, T>(all_planes, planes, values, job, row);
    values += kPlanes;
    row += job.stride;
  }
}

// Scans objects begin ... end - 1 with every query of the job, and writes their
// words. T is the type of planes and queries, in the order of planes.h.
template <class Shape, typename T>
HWY_INLINE void Scan(const kernels::MaskJob& job) {
  ScanAll<Shape, T>(std::make_index_sequence<Shape::kOrder.planes.size()>(),
                    job);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_REJECT_INL_H_
