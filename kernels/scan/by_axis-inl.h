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
#include <utility>

#include "hwy/highway.h"
#include "kernels/scan/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// How many of the groups of a tile, or of its words, have a survivor.
struct Left {
  size_t some;
  size_t all;

  // Whether it is faster to test all objects on the next planes than to visit
  // the groups.
  bool IsAlmostAll() const { return 8 * some > 7 * all; }
};

// Planes that are tested together, from their first objects on: kMins minima,
// then maxima. And the values that they are compared with.
template <size_t kMins, size_t kPlanes, typename T>
struct PlaneGroup {
  const T* planes[kPlanes];
  T values[kPlanes];

  // Calls test(planes, a vector of each value).
  template <class D, class Test>
  HWY_INLINE void With(D d, const Test& test) const {
    [&]<size_t... kPlane>(std::index_sequence<kPlane...>) HWY_ATTR {
      const T* copies[] = {planes[kPlane]...};
      test(copies, hn::Set(d, values[kPlane])...);
    }
    (std::make_index_sequence<kPlanes>());
  }
};

// The group of kAxes axes from `axis` on, from object `first` on. Packs instead
// of loops: gcc would load the pointers as a vector, which waits for the stores
// of the caller's view.
template <size_t kAxes, typename T>
HWY_INLINE PlaneGroup<kAxes, 2 * kAxes, T> AxesFrom(const detail::Scan& scan,
                                                    const T* values,
                                                    size_t axis, size_t first) {
  const size_t axes = scan.type->axes;
  const T* const max_values = values + scan.type->first_max;
  return [&]<size_t... kAxis>(std::index_sequence<kAxis...>) {
    return PlaneGroup<kAxes, 2 * kAxes, T>{
        {scan.Plane<T>(axis + kAxis) + first...,
         scan.Plane<T>(axes + axis + kAxis) + first...},
        {max_values[axis + kAxis]..., values[axis + kAxis]...}};
  }
  (std::make_index_sequence<kAxes>());
}

// The group of all maxima.
template <size_t kAxes, typename T>
HWY_INLINE PlaneGroup<0, kAxes, T> MaximaFrom(const detail::Scan& scan,
                                              const T* values, size_t first) {
  return [&]<size_t... kAxis>(std::index_sequence<kAxis...>) {
    return PlaneGroup<0, kAxes, T>{{scan.Plane<T>(kAxes + kAxis) + first...},
                                   {values[kAxis]...}};
  }
  (std::make_index_sequence<kAxes>());
}

// Tests all objects of some words. The words of the first planes of a scan are
// written, those of later planes are ANDed to them. Not inlined: inside the
// caller, gcc 12 reloads the row's address from the stack for each word.
template <Pack kPack, class D, class Load, size_t kMins, size_t kPlanes,
          typename T>
HWY_NOINLINE void TestAll(D d, Load load,
                          const PlaneGroup<kMins, kPlanes, T>& group,
                          bool is_first, size_t words, uint64_t* row) {
  group.With(d, [&](const T* const* planes, auto... values) HWY_ATTR {
    const auto kept = [&](size_t w) HWY_ATTR {
      return KeptBits<kMins, kWordObjects, kPack>(d, load, planes,
                                                  w * kWordObjects, values...);
    };
    if (is_first) {
      for (size_t w = 0; w < words; ++w) row[w] = kept(w);
    } else {
      for (size_t w = 0; w < words; ++w) row[w] &= kept(w);
    }
  });
}

// Tests the planes on those groups of a tile that have a survivor. Returns the
// number of groups that still have one.
template <class D, class Load, size_t kMins, size_t kPlanes, typename T>
HWY_INLINE size_t TestGroups(D d, Load load,
                             const PlaneGroup<kMins, kPlanes, T>& group,
                             Groups<kGroupObjects>& groups, bool is_last,
                             uint64_t* row) {
  size_t left = 0;
  group.With(d, [&](const T* const* planes, auto... values) HWY_ATTR {
    left = groups.Visit(row, is_last, [&](size_t i) HWY_ATTR {
      return KeptBits<kMins, kGroupObjects>(d, load, planes, i, values...);
    });
  });
  return left;
}

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

// Tests all objects of a tile of one query on the first kFirst axes, and finds
// the groups that have a survivor.
template <size_t kFirst, typename T>
HWY_INLINE Left TestFirst(const detail::Scan& scan, const detail::Chunk& tile,
                          Groups<kGroupObjects>& groups) {
  const size_t words = (tile.end - tile.begin) / kWordObjects;
  TestAll<kInCachePack>(
      WordTag<T>(), LoadAll(),
      AxesFrom<kFirst>(scan, static_cast<const T*>(tile.queries), 0,
                       tile.begin),
      true, words, tile.rows);
  return {groups.Find(tile.rows, words), words * kWordGroups};
}

// Tests a tile of one query on the first kFirst axes, then on one axis after
// the other, for the groups that still have a survivor. If almost all groups
// are left, it tests all objects, on two axes at once. Returns how many groups
// had a survivor after the first axes. In plain code it calls TestBits().
template <size_t kFirst, typename T>
HWY_NOINLINE Left TileByAxis(const detail::Scan& scan,
                             const detail::Chunk& tile) {
  const WordTag<T> d;
  const size_t axes = scan.type->axes;
  const T* const values = static_cast<const T*>(tile.queries);
  const size_t words = (tile.end - tile.begin) / kWordObjects;
  Groups<kGroupObjects> groups;
  const Left after_first = TestFirst<kFirst, T>(scan, tile, groups);
  if constexpr (!kHasVectors) {
    TestBits(scan, values, kFirst, tile.begin, words, tile.rows);
    return after_first;
  }
  Left left = after_first;
  for (size_t k = kFirst; k < axes; ++k) {
    const auto axis = AxesFrom<1>(scan, values, k, tile.begin);
    if (!left.IsAlmostAll()) {
      left.some =
          TestGroups(d, LoadAll(), axis, groups, k + 1 == axes, tile.rows);
      continue;
    }
    if (k + 1 < axes) {
      TestAll<kInCachePack>(d, LoadAll(),
                            AxesFrom<2>(scan, values, k++, tile.begin), false,
                            words, tile.rows);
    } else {
      TestAll<kInCachePack>(d, LoadAll(), axis, false, words, tile.rows);
    }
    if (k + 1 < axes) left.some = groups.Find(tile.rows, words);
  }
  return after_first;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_SCAN_BY_AXIS_INL_H_
