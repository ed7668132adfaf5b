// Where objects are: their centers, and the places of these on Hilbert's curve.
#if defined(HALFSPACE_KERNELS_SORTED_CURVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SORTED_CURVE_INL_H_
#undef HALFSPACE_KERNELS_SORTED_CURVE_INL_H_
#else
#define HALFSPACE_KERNELS_SORTED_CURVE_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/sorted/block.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A simplex' last axis, and a fourth one, tell nothing new.
template <size_t kAxes, bool kHasMax>
inline constexpr size_t kCenterAxes = HWY_MIN(kHasMax ? kAxes : kAxes - 1,
                                              detail::kCenterAxes);

template <class D>
HWY_INLINE hn::Vec<D> NumberOrLast(D d, hn::Vec<D> center) {
  const auto last = hn::Set(d, detail::kLastCenter);
  return hn::IfThenElse(hn::Le(hn::Abs(center), last), center, last);
}

template <size_t kAxes, bool kHasMax>
void FindCenters(const detail::FloatColumns& objects, size_t first,
                 size_t count, detail::Centers& centers) {
  const hn::CappedTag<float, 16> d;
  constexpr size_t kPlanes = kHasMax ? 2 * kAxes : kAxes;
  HWY_ALIGN float values[kPlanes][detail::kBlockObjects];
  for (size_t p = 0; p < kPlanes; ++p) {
    const float* from = objects.planes[p] + first * objects.stride;
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
      if (k < kCenterAxes<kAxes, kHasMax>) {
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

// J. Skilling, "Programming the Hilbert curve" (2004), without branches on the
// bits.
template <size_t kAxes, bool kHasMax>
void FindPlaces(const detail::Centers& centers, const detail::Grid& grid,
                uint32_t* places) {
  constexpr size_t kUsed = kCenterAxes<kAxes, kHasMax>;
  constexpr int kBits = static_cast<int>(detail::kPlaceBits / kUsed);
  constexpr uint32_t kCells = uint32_t{1} << kBits;
  const hn::CappedTag<uint32_t, 16> d;
  const hn::Rebind<float, decltype(d)> df;
  const hn::Rebind<int32_t, decltype(d)> di;
  using V = hn::Vec<decltype(d)>;
  // All ones where a bit is set.
  const auto where_set = [d, di](V v, int bit) HWY_ATTR {
    const auto to_sign = hn::ShiftLeftSame(v, 31 - bit);
    return hn::BitCast(d, hn::ShiftRight<31>(hn::BitCast(di, to_sign)));
  };
  const auto most = hn::Set(df, static_cast<float>(kCells - 1));
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    V cells[3];
    for (size_t k = 0; k < kUsed; ++k) {
      const auto center = hn::LoadU(df, centers[k].data() + i);
      const auto at = hn::Mul(
          hn::Sub(center, hn::Set(df, grid.least[k])),
          hn::Set(df, grid.cells_of_unit[k] * static_cast<float>(kCells)));
      // What is placed last may be no number here: beyond the float's range.
      const auto cell = hn::IfThenElse(hn::Lt(at, most), at, most);
      cells[k] = hn::BitCast(d, hn::ConvertTo(di, hn::Max(cell, hn::Zero(df))));
    }
    for (int bit = kBits - 1; bit > 0; --bit) {
      const auto low = hn::Set(d, (uint32_t{1} << bit) - 1);
      for (size_t k = 0; k < kUsed; ++k) {
        const auto set = where_set(cells[k], bit);
        const auto swapped =
            hn::AndNot(set, hn::And(hn::Xor(cells[0], cells[k]), low));
        cells[k] = hn::Xor(cells[k], swapped);
        cells[0] = hn::Xor(cells[0], hn::Or(hn::And(set, low), swapped));
      }
    }
    for (size_t k = 1; k < kUsed; ++k) {
      cells[k] = hn::Xor(cells[k], cells[k - 1]);
    }
    auto flips = hn::Zero(d);
    for (int bit = kBits - 1; bit > 0; --bit) {
      const auto low = hn::Set(d, (uint32_t{1} << bit) - 1);
      flips = hn::Xor(flips, hn::And(where_set(cells[kUsed - 1], bit), low));
    }
    auto place = hn::Zero(d);
    const auto one = hn::Set(d, 1);
    for (int bit = kBits - 1; bit >= 0; --bit) {
      for (size_t k = 0; k < kUsed; ++k) {
        const auto digit =
            hn::And(hn::ShiftRightSame(hn::Xor(cells[k], flips), bit), one);
        place = hn::Or(hn::ShiftLeft<1>(place), digit);
      }
    }
    hn::StoreU(place, d, places + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SORTED_CURVE_INL_H_
