// Bounds of many point sets: the lanes hold points of one set.
#if defined(HALFSPACE_KERNELS_FIT_MANY_POINT_SETS_INL_H_) == \
    defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_FIT_MANY_POINT_SETS_INL_H_
#undef HALFSPACE_KERNELS_FIT_MANY_POINT_SETS_INL_H_
#else
#define HALFSPACE_KERNELS_FIT_MANY_POINT_SETS_INL_H_
#endif

#include <cfloat>
#include <cmath>
#include <cstddef>

#include "hwy/highway.h"
#include "kernels/fit_many/tiles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// The bound of one set so far.
template <int kDims>
struct SetBound {
  float min[kDims + 1];
  float max[kDims + 1];
  bool ok = true;  // all points can be bounded

  SetBound() {
    for (size_t k = 0; k <= kDims; ++k) {
      min[k] = INFINITY;
      max[k] = -INFINITY;
    }
  }

  void SetEverything() {
    for (size_t k = 0; k <= kDims; ++k) {
      min[k] = -FLT_MAX;
      max[k] = FLT_MAX;
    }
  }

  HWY_INLINE void Widen(size_t axis, float low, float high) {
    min[axis] = low < min[axis] ? low : min[axis];
    max[axis] = high > max[axis] ? high : max[axis];
  }
};

// Widens a bound by `count` points, a multiple of the lanes, in columns.
template <int kDims, class D>
HWY_INLINE void WidenByPoints(D d, const float* const* columns, size_t count,
                              SetBound<kDims>& bound) {
  using V = hn::Vec<D>;
  const size_t lanes = hn::Lanes(d);
  for (size_t k = 0; k < kDims; ++k) {
    V min = hn::LoadU(d, columns[k]);
    V max = min;
    for (size_t i = lanes; i < count; i += lanes) {
      const V x = hn::LoadU(d, columns[k] + i);
      min = hn::Min(min, x);
      max = hn::Max(max, x);
    }
    bound.Widen(k, hn::GetLane(PlusZero(d, hn::MinOfLanes(d, min))),
                hn::GetLane(PlusZero(d, hn::MaxOfLanes(d, max))));
  }
  const V largest = LargestMagnitude(d);
  V d_min = hn::Set(d, INFINITY);
  V d_max = hn::Set(d, -INFINITY);
  auto ok = hn::Eq(d_min, d_min);
  for (size_t i = 0; i < count; i += lanes) {
    ok = hn::And(ok, hn::Le(Magnitude<kDims>(d, columns, i), largest));
    WidenD<kDims>(d, columns, i, d_min, d_max);
  }
  FinishD<kDims>(d, d_min, d_max);
  bound.ok &= hn::AllTrue(d, ok);
  bound.Widen(kDims, hn::GetLane(hn::MinOfLanes(d, d_min)),
              hn::GetLane(hn::MaxOfLanes(d, d_max)));
}

// Points begin .. begin + count - 1, through a tile if they are not already in
// columns.
template <int kDims>
HWY_INLINE void WidenBySet(const kernels::FitJob& job, size_t begin,
                           size_t count, InputTile<kDims>& tile,
                           SetBound<kDims>& bound) {
  const FitTag d;
  const size_t lanes = hn::Lanes(d);
  size_t done = 0;
  if (job.columns.stride == 1 && count >= lanes) {
    const float* columns[kDims];
    for (size_t k = 0; k < kDims; ++k)
      columns[k] = job.columns.floats(k) + begin;
    done = count / lanes * lanes;
    WidenByPoints<kDims>(d, columns, done, bound);
  }
  while (done < count) {
    const size_t points = HWY_MIN(kTileObjects, count - done);
    tile.Read(job, begin + done, points);
    // The last vector is filled up with its first point: no bound changes.
    const size_t whole = (points + lanes - 1) / lanes * lanes;
    for (size_t k = 0; k < kDims; ++k) {
      for (size_t i = points; i < whole; ++i) {
        tile.values[k][i] = tile.values[k][0];
      }
    }
    WidenByPoints<kDims>(d, tile.columns, whole, bound);
    done += points;
  }
}

template <int kDims>
kernels::FitTally FitPointSets(const kernels::FitJob& job) {
  kernels::FitTally tally{.target = HWY_TARGET};
  const OutputPlanes<kDims> out(job, 0);
  InputTile<kDims> tile;
  size_t begin = 0;
  for (size_t i = 0; i < job.size; ++i) {
    const size_t end = job.ends[i];
    SetBound<kDims> bound;
    bound.ok = begin <= end && end <= job.columns.size;
    if (bound.ok) {
      WidenBySet<kDims>(job, begin, end - begin, tile, bound);
    }
    if (!bound.ok) {
      bound.SetEverything();
      tally.Count(1, i);
    }
    for (size_t k = 0; k <= kDims; ++k) {
      if (out.min(k) != nullptr) out.min(k)[i] = bound.min[k];
      if (out.max(k) != nullptr) out.max(k)[i] = bound.max[k];
    }
    begin = end;
  }
  return tally;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_FIT_MANY_POINT_SETS_INL_H_
