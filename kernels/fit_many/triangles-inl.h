// Bounds of many triangles, by the indices of their corners.
#if defined(HALFSPACE_KERNELS_FIT_MANY_TRIANGLES_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_TRIANGLES_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_TRIANGLES_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_TRIANGLES_INL_H_
#endif

#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/fit_many/tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

template <int kDimensions>
struct TriangleBuilder {
  using Tag = FitTag;
  static constexpr int kDims = kDimensions;
  static constexpr size_t kCorners = 3;
  static constexpr size_t kColumns = kCorners * kDims;

  // Gathers the corners; a NaN, which cannot be bounded, stands for those that
  // do not exist.
  void Read(InputTile<kColumns>& tile, const kernels::FitJob& job, size_t begin,
            size_t count) const {
    const uint32_t* indices = job.indices + begin * kCorners;
    for (size_t i = 0; i < count; ++i) {
      for (size_t corner = 0; corner < kCorners; ++corner) {
        const size_t index = indices[i * kCorners + corner];
        for (size_t k = 0; k < kDims; ++k) {
          tile.values[corner * kDims + k][i] =
              index < job.columns.size
                  ? job.columns.floats(k)[index * job.columns.stride]
                  : NAN;
        }
      }
    }
  }

  template <StoreMode kStore, class D>
  HWY_INLINE void FitVector(D d, const float* const* columns,
                            const OutputPlanes<kDims>& out, size_t i,
                            size_t begin, kernels::FitTally& tally) const {
    const auto largest = LargestMagnitude(d);
    const auto ok = hn::And(
        hn::Le(Magnitude<kDims>(d, columns, i), largest),
        hn::And(hn::Le(Magnitude<kDims>(d, columns + kDims, i), largest),
                hn::Le(Magnitude<kDims>(d, columns + 2 * kDims, i), largest)));
    if (HWY_LIKELY(hn::AllTrue(d, ok))) {
      StoreBounds<true, kStore>(d, columns, out, i, ok);
    } else {
      CountEverything(d, hn::Not(ok), i, begin, tally);
      StoreBounds<false, kStore>(d, columns, out, i, ok);
    }
  }

 private:
  template <bool kAll, StoreMode kStore, class D, class M>
  static HWY_INLINE void StoreBounds(D d, const float* const* columns,
                                     const OutputPlanes<kDims>& out, size_t i,
                                     M ok) {
    using V = hn::Vec<D>;
    const float* const* a = columns;
    const float* const* b = columns + kDims;
    const float* const* c = columns + 2 * kDims;
    const V lowest = hn::Set(d, -FLT_MAX);
    const V highest = hn::Set(d, FLT_MAX);
    for (size_t k = 0; k < kDims; ++k) {
      const V x = hn::LoadU(d, a[k] + i);
      const V y = hn::LoadU(d, b[k] + i);
      const V z = hn::LoadU(d, c[k] + i);
      const V min = PlusZero(d, hn::Min(x, hn::Min(y, z)));
      const V max = PlusZero(d, hn::Max(x, hn::Max(y, z)));
      StoreWanted<kAll, kStore>(d, min, ok, lowest, out.min(k), i);
      StoreWanted<kAll, kStore>(d, max, ok, highest, out.max(k), i);
    }
    if (out.min(kDims) == nullptr && out.max(kDims) == nullptr) return;
    V d_min = hn::Set(d, INFINITY);
    V d_max = hn::Set(d, -INFINITY);
    WidenD<kDims>(d, a, i, d_min, d_max);
    WidenD<kDims>(d, b, i, d_min, d_max);
    WidenD<kDims>(d, c, i, d_min, d_max);
    FinishD<kDims>(d, d_min, d_max);
    StoreWanted<kAll, kStore>(d, d_min, ok, lowest, out.min(kDims), i);
    StoreWanted<kAll, kStore>(d, d_max, ok, highest, out.max(kDims), i);
  }
};

template <int kDims>
kernels::FitTally FitTriangles(const kernels::FitJob& job) {
  return FitAll(TriangleBuilder<kDims>(), job, /*is_read_in_place=*/false);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_TRIANGLES_INL_H_
