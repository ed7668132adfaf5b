// A staged scan of small groups: after each stage, a list of the groups that
// are left. For stages that leave many groups.
#if defined(HALFSPACE_KERNELS_STAGED_GROUPS_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_STAGED_GROUPS_INL_H_
#undef HALFSPACE_KERNELS_STAGED_GROUPS_INL_H_
#else
#define HALFSPACE_KERNELS_STAGED_GROUPS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/word_tests-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

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
template <class Shape, size_t kGroup, size_t kStage, class D, class Load,
          typename T, class... V>
HWY_INLINE void TestLiveGroups(D d, Load load, const T* const* planes,
                               size_t first, Tile& tile, V... query) {
  constexpr size_t kBegin = Shape::kOrder.stage_ends[kStage - 1];
  constexpr size_t kEnd = Shape::kOrder.stage_ends[kStage];
  constexpr bool kLast = kStage + 1 == Shape::kOrder.stage_ends.size();
  const size_t count = tile.live_count;
  tile.live_count = 0;
  for (size_t j = 0; j < count; ++j) {
    const size_t offset = tile.live[j];
    tile.words[offset / kWordObjects] |=
        BitsRejected<Shape, kGroup, kBegin, kEnd>(d, load, planes,
                                                  first + offset, query...)
        << (offset % kWordObjects);
    if constexpr (!kLast) tile.AppendIfLive<kGroup>(offset);
  }
  if constexpr (!kLast) {
    TestLiveGroups<Shape, kGroup, kStage + 1>(d, load, planes, first, tile,
                                              query...);
  }
}

// Stage after stage over a tile of words; a stage sees only the groups that the
// stages before it left.
template <class Shape, class D, class Load, typename T, class... V>
HWY_INLINE void ScanGroupsStaged(D d, Load load, const T* const* planes,
                                 size_t first, size_t words, uint64_t* row,
                                 uint64_t flip, V... query) {
#if HWY_HAVE_SCALABLE
  // A group must hold a whole vector, whose length is not known here.
  constexpr size_t kGroup = kWordObjects;
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
              d, load, planes, tile_first + w * kWordObjects, query...);
      for (size_t g = 0; g < kWordObjects; g += kGroup) {
        tile.AppendIfLive<kGroup>(w * kWordObjects + g);
      }
    }
    TestLiveGroups<Shape, kGroup, 1>(d, load, planes, tile_first, tile,
                                     query...);
    for (size_t w = 0; w < tile_words; ++w) {
      row[begin + w] = tile.words[w] ^ flip;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_STAGED_GROUPS_INL_H_
