// The centers of objects, and the places of these on Hilbert's curve.
#if defined(HALFSPACE_KERNELS_BVH_CURVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_CURVE_INL_H_
#undef HALFSPACE_KERNELS_BVH_CURVE_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_CURVE_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/bvh/kernel_table.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The number of axes that centers have. The last axis of a simplex, and a
// fourth axis, follow from the others.
template <size_t kAxes, bool kHasMax>
inline constexpr size_t kAxesOfCenters = HWY_MIN(kHasMax ? kAxes : kAxes - 1,
                                                 detail::kCenterAxes);

template <class D>
HWY_INLINE hn::Vec<D> NumberOrLast(D d, hn::Vec<D> center) {
  const auto last = hn::Set(d, detail::kLastCenter);
  return hn::IfThenElse(hn::Le(hn::Abs(center), last), center, last);
}

template <size_t kAxes, bool kHasMax>
void FindCenters(const detail::Columns& objects, size_t first, size_t count,
                 detail::Centers& centers) {
  const hn::CappedTag<float, 16> d;
  constexpr size_t kPlanes = kHasMax ? 2 * kAxes : kAxes;
  HWY_ALIGN float values[kPlanes][detail::kBlockObjects];
  for (size_t p = 0; p < kPlanes; ++p) {
    const float* from = objects.floats(p) + first * objects.stride;
    for (size_t i = 0; i < count; ++i) values[p][i] = from[i * objects.stride];
    for (size_t i = count; i < detail::kBlockObjects; ++i) values[p][i] = 0;
  }
  const auto half = hn::Set(d, 0.5f);
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    // The centroid of a simplex is equally far from all its planes.
    auto slack = hn::Zero(d);
    if constexpr (!kHasMax) {
      for (size_t k = 0; k < kAxes; ++k) {
        slack = hn::Sub(slack, hn::Load(d, values[k] + i));
      }
      slack = hn::Mul(slack, hn::Set(d, 1.0f / static_cast<float>(kAxes)));
    }
    for (size_t k = 0; k < detail::kCenterAxes; ++k) {
      auto center = hn::Zero(d);
      if (k < kAxesOfCenters<kAxes, kHasMax>) {
        center = hn::Load(d, values[k] + i);
        if constexpr (kHasMax) {
          center = hn::Add(hn::Mul(half, center),
                           hn::Mul(half, hn::Load(d, values[kAxes + k] + i)));
        } else {
          center = hn::Add(center, slack);
        }
      }
      hn::StoreU(NumberOrLast(d, center), d, centers[k].data() + i);
    }
  }
}

// All ones where a bit is set.
template <class D>
HWY_INLINE hn::Vec<D> WhereSet(D d, hn::Vec<D> v, int bit) {
  const hn::Rebind<int32_t, D> di;
  const auto to_sign = hn::ShiftLeftSame(v, 31 - bit);
  return hn::BitCast(d, hn::ShiftRight<31>(hn::BitCast(di, to_sign)));
}

template <class D>
HWY_INLINE hn::Vec<D> CellsOf(D d, const float* centers, float least,
                              float cells_of_unit, uint32_t cells) {
  const hn::Rebind<float, D> df;
  const hn::Rebind<int32_t, D> di;
  const auto most = hn::Set(df, static_cast<float>(cells - 1));
  const auto at =
      hn::Mul(hn::Sub(hn::LoadU(df, centers), hn::Set(df, least)),
              hn::Set(df, cells_of_unit * static_cast<float>(cells)));
  // An object without a center can be NaN here, because the product overflows.
  const auto cell = hn::IfThenElse(hn::Lt(at, most), at, most);
  return hn::BitCast(d, hn::ConvertTo(di, hn::Max(cell, hn::Zero(df))));
}

// Exchanges the low bits of two axes, or flips the low bits of the first axis.
template <class D, class V>
HWY_INLINE void Turn(D d, int bit, V& first, V& axis) {
  const auto low = hn::Set(d, (uint32_t{1} << bit) - 1);
  const auto set = WhereSet(d, axis, bit);
  const auto swapped = hn::AndNot(set, hn::And(hn::Xor(first, axis), low));
  axis = hn::Xor(axis, swapped);
  first = hn::Xor(first, hn::Or(hn::And(set, low), swapped));
}

template <class V>
HWY_INLINE V WithBit(V place, V axis, int bit) {
  const hn::DFromV<V> d;
  const auto digit = hn::And(hn::ShiftRightSame(axis, bit), hn::Set(d, 1));
  return hn::Or(hn::ShiftLeft<1>(place), digit);
}

// J. Skilling, "Programming the Hilbert curve" (2004), without branches on the
// bits.
template <size_t kUsed>
void FindPlaces(const detail::Centers& centers, const detail::Grid& grid,
                uint32_t* places) {
  static_assert(kUsed == 2 || kUsed == 3);
  constexpr int kBits = static_cast<int>(detail::kPlaceBits / kUsed);
  constexpr uint32_t kCells = uint32_t{1} << kBits;
  const hn::CappedTag<uint32_t, 16> d;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto cells_of = [&](size_t k) HWY_ATTR {
      return CellsOf(d, centers[k].data() + i, grid.least[k],
                     grid.cells_of_unit[k], kCells);
    };
    auto x = cells_of(0);
    auto y = cells_of(1);
    auto z = cells_of(kUsed - 1);
    for (int bit = kBits - 1; bit > 0; --bit) {
      const auto low = hn::Set(d, (uint32_t{1} << bit) - 1);
      x = hn::Xor(x, hn::And(WhereSet(d, x, bit), low));
      Turn(d, bit, x, y);
      if (kUsed == 3) Turn(d, bit, x, z);
    }
    y = hn::Xor(y, x);
    z = kUsed == 3 ? hn::Xor(z, y) : y;
    auto flips = hn::Zero(d);
    for (int bit = kBits - 1; bit > 0; --bit) {
      const auto low = hn::Set(d, (uint32_t{1} << bit) - 1);
      flips = hn::Xor(flips, hn::And(WhereSet(d, z, bit), low));
    }
    x = hn::Xor(x, flips);
    y = hn::Xor(y, flips);
    z = hn::Xor(z, flips);
    auto place = hn::Zero(d);
    for (int bit = kBits - 1; bit >= 0; --bit) {
      place = WithBit(place, x, bit);
      place = WithBit(place, y, bit);
      if (kUsed == 3) place = WithBit(place, z, bit);
    }
    hn::StoreU(place, d, places + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_CURVE_INL_H_
