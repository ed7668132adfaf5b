// Scans by axis: the planes of the first axes for all objects, then those of
// one axis after the other for the groups of objects that still have a
// survivor.
#if defined(HALFSPACE_KERNELS_SCAN_BY_AXIS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_SCAN_BY_AXIS_INL_H_
#undef HALFSPACE_KERNELS_SCAN_BY_AXIS_INL_H_
#else
#define HALFSPACE_KERNELS_SCAN_BY_AXIS_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "kernels/scan/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// 4096 objects: one word has a bit for each of their words, and what a stage
// keeps for the next one stays in L1.
inline constexpr size_t kTileWords = 64;

#if HWY_HAVE_SCALABLE
// A group must hold a whole vector, whose length is not known here.
inline constexpr size_t kGroupObjects = kWordObjects;
#else
inline constexpr size_t kGroupObjects = 16;
#endif
inline constexpr size_t kWordGroups = kWordObjects / kGroupObjects;

// How many of some groups, or words, have a survivor.
struct Left {
  size_t some;
  size_t all;

  // Whether it is faster to test all objects on the next planes than to visit
  // the groups. Measured on a box: at 3 % of the world's side the second axis
  // finds 63 % of the groups and the third 6 %, at 10 % 96 % and 48 %.
  bool IsMany() const { return 8 * some > 3 * all; }

  // Whether the next axis is expected to leave many, too: objects of about 7 %
  // of the world's side and more.
  bool IsAlmostAll() const { return 8 * some > 7 * all; }
};

// Tests the planes of axes `axis`, `axis` + 1, ... for each bit of the words,
// all of them without a branch. In plain code this takes 0.5 to 0.9 of the time
// of groups from objects of 1 % on, and 1.0 to 1.1 below (a box on Zen 3).
template <typename T>
HWY_INLINE void TestBits(const detail::Scan& scan, const T* values, size_t axis,
                         size_t first, size_t words,
                         uint64_t* HWY_RESTRICT row) {
  const size_t axes = scan.type->axes;
  for (size_t w = 0; w < words; ++w) {
    uint64_t kept = row[w];
    for (uint64_t left = kept; left != 0; left &= left - 1) {
      const size_t bit = hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
      const size_t i = first + w * kWordObjects + bit;
      bool is_rejected = false;
      for (size_t k = axis; k < axes; ++k) {
        is_rejected |= scan.Plane<T>(k)[i] > values[scan.type->first_max + k];
        is_rejected |= scan.Plane<T>(axes + k)[i] < values[k];
      }
      kept &= ~(uint64_t{is_rejected} << bit);
    }
    row[w] = kept;
  }
}

// Tests the planes of the first kFirst axes for all objects of a tile, then
// those of one axis after the other, for the groups that still have a survivor.
// If many groups are left, it tests all of them, and two axes at once if almost
// all are. Returns how many groups had a survivor after the first axes. In
// plain code it calls TestBits() and returns nothing.
//
// The groups are found by vectors and visited by their bits, because which
// groups survive cannot be predicted: a branch for each took three times as
// long as a flat scan. Groups of 16 took up to 0.85 of the time of groups of
// 64, and bits 0.6 of that of a list (a box in L2 on Zen 3).
template <size_t kFirst, class D, typename T>
HWY_INLINE Left TileByAxis(const detail::Scan& scan, const T* values,
                           size_t first, size_t words,
                           uint64_t* HWY_RESTRICT row) {
  const D d;
  const size_t axes = scan.type->axes;
  const T* max_values = values + scan.type->first_max;
  const auto min_plane = [&](size_t k) { return scan.Plane<T>(k) + first; };
  const auto max_plane = [&](size_t k) {
    return scan.Plane<T>(axes + k) + first;
  };
  // Calls take(w, kept bits) for each word, of one axis or of two.
  const auto test_axis = [&](size_t k, const auto& take) HWY_ATTR {
    const T* planes[] = {min_plane(k), max_plane(k)};
    const auto max = hn::Set(d, max_values[k]);
    const auto min = hn::Set(d, values[k]);
    for (size_t w = 0; w < words; ++w) {
      take(w, KeptBits<1>(d, LoadAll(), planes, w * kWordObjects, max, min));
    }
  };
  const auto test_two_axes = [&](size_t k, const auto& take) HWY_ATTR {
    const T* planes[] = {min_plane(k), min_plane(k + 1), max_plane(k),
                         max_plane(k + 1)};
    const auto max0 = hn::Set(d, max_values[k]);
    const auto max1 = hn::Set(d, max_values[k + 1]);
    const auto min0 = hn::Set(d, values[k]);
    const auto min1 = hn::Set(d, values[k + 1]);
    for (size_t w = 0; w < words; ++w) {
      take(w, KeptBits<2>(d, LoadAll(), planes, w * kWordObjects, max0, max1,
                          min0, min1));
    }
  };
  const auto write = [row](size_t w, uint64_t kept) { row[w] = kept; };
  const auto add = [row](size_t w, uint64_t kept) { row[w] &= kept; };
  static_assert(kFirst == 1 || kFirst == 2);
  if constexpr (kFirst == 1) {
    test_axis(0, write);
  } else {
    test_two_axes(0, write);
  }
  if constexpr (!kHasVectors) {
    TestBits(scan, values, kFirst, first, words, row);
    return Left{};
  }
  uint64_t groups[kTileWords * kWordGroups / 64] = {};
  const Left after_first{NonzeroGroups<kGroupObjects>(row, words, groups),
                         words * kWordGroups};
  Left left = after_first;
  for (size_t k = kFirst; k < axes; ++k) {
    if (k + 1 < axes && left.IsAlmostAll()) {
      test_two_axes(k++, add);
    } else if (left.IsMany()) {
      test_axis(k, add);
    } else {
      const T* planes[] = {min_plane(k), max_plane(k)};
      const auto max = hn::Set(d, max_values[k]);
      const auto min = hn::Set(d, values[k]);
      VisitGroups<kGroupObjects>(groups, words, row, [&](size_t i) HWY_ATTR {
        return KeptBits<1, kGroupObjects>(d, LoadAll(), planes, i, max, min);
      });
    }
    if (k + 1 < axes) {
      left.some = NonzeroGroups<kGroupObjects>(row, words, groups);
    }
  }
  return after_first;
}

// The same for whole words of one query. Not inlined: two kernels call it.
template <size_t kFirst, class D>
HWY_NOINLINE Left TilesByAxis(const detail::Scan& scan,
                              const detail::Chunk& chunk) {
  using T = hn::TFromD<D>;
  const size_t words = (chunk.end - chunk.begin) / kWordObjects;
  Left left{};
  for (size_t begin = 0; begin < words; begin += kTileWords) {
    const Left tile = TileByAxis<kFirst, D>(
        scan, static_cast<const T*>(chunk.queries),
        chunk.begin + begin * kWordObjects, HWY_MIN(kTileWords, words - begin),
        chunk.rows + begin);
    left.some += tile.some;
    left.all += tile.all;
  }
  return left;
}

template <size_t kFirst, typename T>
HWY_INLINE Left RangeByAxis(const detail::Scan& scan,
                            const detail::Chunk& chunk) {
  return WithVectors<T>(scan, [&](auto d) HWY_ATTR {
    return TilesByAxis<kFirst, decltype(d)>(scan, chunk);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_BY_AXIS_INL_H_
