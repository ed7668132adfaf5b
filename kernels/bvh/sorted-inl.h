// The lanes of a block in the order of their keys.
#if defined(HALFSPACE_KERNELS_BVH_SORTED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_SORTED_INL_H_
#undef HALFSPACE_KERNELS_BVH_SORTED_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_SORTED_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/compiler.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Sorted by key, and then by lane. Keys are not negative.
struct SortedLanes {
  size_t count;
  uint64_t keyed[detail::kBlockObjects];

  HWY_INLINE size_t LaneOf(size_t i) const {
    return keyed[i] % detail::kBlockObjects;
  }

  HWY_NOINLINE void Sort(uint64_t bits, const float* keys) {
    uint64_t in_order[detail::kBlockObjects];
    count = 0;
    for (; bits != 0; bits &= bits - 1) {
      const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      in_order[count++] =
          uint64_t{kernels::BitCast<uint32_t>(keys[lane])} << 32 | lane;
    }
    // The place of each is the number of lesser ones. This has no branches,
    // which would be mispredicted.
    for (size_t i = 0; i < count; ++i) {
      size_t less = 0;
      for (size_t j = 0; j < count; ++j) less += in_order[j] < in_order[i];
      keyed[less] = in_order[i];
    }
  }
};

// Prefetches the floats of a block.
inline void PrefetchPlanes(const detail::BvhLevel& level, size_t block) {
  constexpr size_t kLine = 64 / sizeof(float);
  const float* const floats = level.Plane(block, 0);
  for (size_t i = 0; i < level.planes * detail::kBlockObjects; i += kLine) {
    kernels::Prefetch(floats + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_SORTED_INL_H_
