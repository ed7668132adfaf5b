// What happens to each word of rejections. A sink's Take(first, rejected) gets
// 64 objects from `first` on, bits past the last object set, and says whether
// to go on.
#if defined(HALFSPACE_KERNELS_SINKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SINKS_INL_H_
#undef HALFSPACE_KERNELS_SINKS_INL_H_
#else
#define HALFSPACE_KERNELS_SINKS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// Stores the mask. `flip` is 0 for a reject mask, ~0 for a survivor mask.
struct MaskSink {
  uint64_t* mask;
  uint64_t flip;

  HWY_INLINE bool Take(size_t first, uint64_t rejected) {
    mask[first / 64] = rejected ^ flip;
    return true;
  }
};

struct CountSink {
  size_t count = 0;

  HWY_INLINE bool Take(size_t /*first*/, uint64_t rejected) {
    count += hwy::PopCount(~rejected);
    return true;
  }
};

// Stores the survivors' indices while they fit, and counts them all.
struct IndexSink {
  uint32_t* indices;
  size_t capacity;
  size_t count = 0;

  HWY_INLINE bool Take(size_t first, uint64_t rejected) {
    for (uint64_t left = ~rejected; left != 0; left &= left - 1) {
      if (count < capacity) {
        indices[count] = static_cast<uint32_t>(
            first + hwy::Num0BitsBelowLS1Bit_Nonzero64(left));
      }
      ++count;
    }
    return true;
  }
};

struct AnySink {
  bool any = false;

  HWY_INLINE bool Take(size_t /*first*/, uint64_t rejected) {
    any = ~rejected != 0;
    return !any;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SINKS_INL_H_
