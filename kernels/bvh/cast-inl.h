// Finds the objects that a line enters, in one pass. The children of a node are
// visited in the order in which the line enters them, up to a limit that the
// caller's function may reduce. The line enters a node no later than the
// objects in it.
#if defined(HALFSPACE_KERNELS_BVH_CAST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_CAST_INL_H_
#undef HALFSPACE_KERNELS_BVH_CAST_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_CAST_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/bvh/nearest.h"
#include "kernels/bvh/shape_query.h"
#include "kernels/bvh/shapes-inl.h"
#include "kernels/bvh/sorted-inl.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

class Caster {
 public:
  explicit Caster(const detail::LineSearch& search)
      : search_(search),
        levels_(*search.levels),
        has_masks_(levels_.level[0].masks != nullptr && ~search.mask != 0),
        limit_(search.line.max_t) {}

  void Cast() { Visit(TopLevel(levels_), 0); }

 private:
  HWY_NOINLINE bool Visit(size_t level, size_t block) {
    HWY_ALIGN float keys[detail::kBlockObjects];
    const uint64_t bits = ReadKeys(level, block, keys);
    if (bits == 0) return true;
    SortedLanes sorted;
    sorted.Sort(bits, keys);
    const size_t first = block * detail::kBlockObjects;
    for (size_t i = 0; i < sorted.count; ++i) {
      const size_t lane = sorted.LaneOf(i);
      if (keys[lane] > limit_ + detail::kApartOnLine) return true;
      if (level == 0) {
        if (!Take(block, lane, keys[lane])) return false;
        continue;
      }
      const detail::BvhLevel& below = levels_.level[level - 1];
      if (below.is_prefetched && i + 1 < sorted.count) {
        PrefetchPlanes(below, first + sorted.LaneOf(i + 1));
      }
      if (!Visit(level - 1, first + lane)) return false;
    }
    return true;
  }

  bool Take(size_t block, size_t lane, float t) {
    const float limit = search_.function(
        search_.context, levels_.ids[block * detail::kBlockObjects + lane],
        detail::ReportedTime(t), levels_.level[0].Plane(block, 0) + lane);
    if (limit < limit_) limit_ = limit;
    return limit_ >= 0;
  }

  // Writes where the line enters the nodes or objects of a block. Returns a bit
  // for each that it enters up to the limit. kAxes is as in EntryOf().
  template <size_t kAxes>
  HWY_NOINLINE uint64_t ReadKeysOf(size_t level, size_t block,
                                   float* keys) const {
    const detail::BvhLevel& nodes = levels_.level[level];
    const size_t first = block * detail::kBlockObjects;
    const WordTag<float> d;
    const size_t end = HWY_MIN(detail::kBlockObjects, nodes.size - first);
    uint64_t bits = 0;
    for (size_t i = 0; i < end; i += hn::Lanes(d)) {
      auto exit = hn::Set(d, limit_);
      const auto enter = EntryOf<kAxes>(d, nodes, block, i, search_.line, exit);
      bits |= LaneBits(d, hn::Le(enter, exit)) << i;
      hn::Store(enter, d, keys + i);
    }
    bits &= nodes.present[block];
    if (bits != 0 && has_masks_) {
      bits &= MaskBits(nodes.masks + first, search_.mask);
    }
    return bits;
  }

  HWY_INLINE uint64_t ReadKeys(size_t level, size_t block, float* keys) const {
    const bool has_pairs = search_.line.planes == 2 * search_.line.entering;
    switch (has_pairs ? search_.line.entering : 0) {
      case 2:
        return ReadKeysOf<2>(level, block, keys);
      case 3:
        return ReadKeysOf<3>(level, block, keys);
      case 4:
        return ReadKeysOf<4>(level, block, keys);
      default:
        return ReadKeysOf<0>(level, block, keys);
    }
  }

  const detail::LineSearch& search_;
  const detail::BvhLevels& levels_;
  const bool has_masks_;
  float limit_;
};

inline void CastLine(const detail::LineSearch& search) {
  Caster(search).Cast();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_CAST_INL_H_
