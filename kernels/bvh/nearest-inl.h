// Finds the objects with the least keys. The search enters the nearest node
// first, and then others as long as they can have an object that is nearer than
// the last one found. The key and the first slot of a node are at most those of
// all objects in it, so the result is exact, ties included, and the search
// remembers one node of each level.
#if defined(HALFSPACE_KERNELS_BVH_NEAREST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
#undef HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hwy/highway.h"
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/bvh/nearest.h"
#include "kernels/bvh/shapes-inl.h"
#include "kernels/bvh/sorted-inl.h"
#include "kernels/compiler.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The least keys found so far.
class NearestList {
 public:
  explicit NearestList(const detail::NearestSearch& search)
      : found_(search.found),
        room_(search.room),
        worst_(detail::Keyed(search.limit, ~uint32_t{0})) {}

  size_t count() const { return count_; }
  // The search passes over objects and nodes that are greater.
  detail::KeyedSlot worst() const { return worst_; }

  // Adds to a sorted list.
  void AddSorted(detail::KeyedSlot keyed) {
    size_t i = count_ < room_ ? count_++ : count_ - 1;
    for (; i > 0 && found_[i - 1] > keyed; --i) found_[i] = found_[i - 1];
    found_[i] = keyed;
    if (count_ == room_) worst_ = found_[count_ - 1];
  }

  // Adds to a list without an order. When the list is full, it becomes a heap.
  // Its first element is the greatest, and the next one that is added replaces
  // it.
  HWY_NOINLINE void AddToHeap(detail::KeyedSlot keyed) {
    if (count_ < room_) {
      found_[count_++] = keyed;
      if (count_ < room_) return;
      for (size_t i = count_ / kChildren + 1; i-- > 0;) {
        SiftDown(i, found_[i]);
      }
    } else {
      SiftDown(0, keyed);
    }
    worst_ = found_[0];
  }

  void Sort() const {
    detail::KeyedSlot differing = 1;  // never 0, to have a highest bit
    for (size_t i = 1; i < count_; ++i) {
      differing |= found_[i] ^ found_[0];
    }
    Sort(0, count_,
         63 - static_cast<int>(hwy::Num0BitsAboveMS1Bit_Nonzero64(differing)));
  }

 private:
  // Writes `keyed` to element i of the heap, or below it. With four children
  // there are half as many levels, and the children are neighbours in memory.
  static constexpr size_t kChildren = 4;
  void SiftDown(size_t i, detail::KeyedSlot keyed) const {
    for (;;) {
      size_t child = kChildren * i + 1;
      if (child >= count_) break;
      const size_t end = HWY_MIN(child + kChildren, count_);
      size_t most = child;
      detail::KeyedSlot most_keyed = found_[child];
      while (++child < end) {  // selects, as branches would be mispredicted
        const bool is_more = found_[child] > most_keyed;
        most = is_more ? child : most;
        most_keyed = is_more ? found_[child] : most_keyed;
      }
      if (most_keyed <= keyed) break;
      found_[i] = most_keyed;
      i = most;
    }
    found_[i] = keyed;
  }

  // Sorts by one bit after another, from the highest bit that differs. Each
  // pass reads memory in order and has no branch that could be mispredicted. To
  // sort a heap of a million takes two to three times as long.
  HWY_NOINLINE void Sort(size_t begin, size_t end, int bit) const {
    while (end - begin > 16 && bit >= 0) {
      size_t middle = begin;
      for (size_t i = begin; i < end; ++i) {
        const detail::KeyedSlot keyed = found_[i];
        found_[i] = found_[middle];
        found_[middle] = keyed;
        middle += (~keyed >> bit) & 1;
      }
      --bit;
      Sort(begin, middle, bit);
      begin = middle;
    }
    for (size_t i = begin; i < end; ++i) {
      const detail::KeyedSlot keyed = found_[i];
      size_t to = i;
      for (; to > begin && found_[to - 1] > keyed; --to) {
        found_[to] = found_[to - 1];
      }
      found_[to] = keyed;
    }
  }

  detail::KeyedSlot* const found_;
  const size_t room_;
  size_t count_ = 0;
  detail::KeyedSlot worst_;
};

class NearestFinder {
 public:
  explicit NearestFinder(const detail::NearestSearch& search)
      : search_(search),
        has_masks_(search.levels->level[0].masks != nullptr &&
                   ~search.mask != 0),
        is_many_(search.room >= detail::kBlockObjects),
        list_(search) {}

  size_t Find() {
    Visit(search_.levels->count - 1, 0);
    if (is_many_) list_.Sort();
    return list_.count();
  }

 private:
  static constexpr float kInf = std::numeric_limits<float>::infinity();
  // More nodes than this are not sorted. The nearest is visited first, and
  // after that few are left.
  static constexpr size_t kFew = 4;
  static constexpr size_t kGroups = 16;  // of lanes, in OfLeastGroups()
  // The lowest bits of a key, which AboutLeast() does not compare.
  static constexpr uint32_t kLaneBits = detail::kBlockObjects - 1;

  HWY_NOINLINE void Visit(size_t level, size_t block) {
    HWY_ALIGN float keys[detail::kBlockObjects];
    // The end of the last vector that has nodes or objects. Others are not
    // read.
    const size_t lanes = hn::Lanes(WordTag<float>());
    const size_t size =
        search_.levels->level[level].size - block * detail::kBlockObjects;
    const size_t end =
        HWY_MIN(detail::kBlockObjects, (size + lanes - 1) / lanes * lanes);
    uint64_t bits = ReadKeys(level, block, end, keys);
    const size_t first = block * detail::kBlockObjects;
    if (level == 0) {
      TakeObjects(first, bits, end, keys);
      return;
    }
    if (hwy::PopCount(bits) > kFew) {
      const size_t lane = AboutLeast(keys, end);
      Visit(level - 1, first + lane);
      bits &= LanesUpTo(detail::KeyOf(list_.worst()), keys, end);
      bits &= ~(uint64_t{1} << lane);
    }
    SortedLanes sorted;
    sorted.Sort(bits, keys);
    const detail::BvhLevel& below = search_.levels->level[level - 1];
    for (size_t i = 0; i < sorted.count; ++i) {
      const size_t place = first + sorted.LaneOf(i);
      const size_t first_slot = place << (6 * level);
      if (detail::Keyed(keys[sorted.LaneOf(i)], first_slot) > list_.worst()) {
        return;
      }
      if (below.is_prefetched && i + 1 < sorted.count) {
        PrefetchPlanes(below, first + sorted.LaneOf(i + 1));
      }
      Visit(level - 1, place);
    }
  }

  // Adds the objects of a leaf whose bits are set.
  HWY_INLINE void TakeObjects(size_t first, uint64_t bits, size_t end,
                              const float* keys) {
    if (!is_many_ && hwy::PopCount(bits) > kFew && search_.from == 0) {
      if (search_.room == 1) {
        const float least = keys[AboutLeast(keys, end)];
        bits &= LanesUpTo(kernels::BitCast<float>(
                              kernels::BitCast<uint32_t>(least) | kLaneBits),
                          keys, end);
      } else {
        TakeSorted(first, bits, end, keys);
        return;
      }
    }
    for (; bits != 0; bits &= bits - 1) {
      const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      const detail::KeyedSlot keyed = detail::Keyed(keys[lane], first + lane);
      if (keyed < search_.from || keyed > list_.worst()) continue;
      if (is_many_) {
        list_.AddToHeap(keyed);
      } else {
        list_.AddSorted(keyed);
      }
    }
  }

  HWY_INLINE void TakeSorted(size_t first, uint64_t bits, size_t end,
                             const float* keys) {
    if (hwy::PopCount(bits) > kGroups && search_.room <= kGroups) {
      bits &= OfLeastGroups(keys, end);
    }
    SortedLanes sorted;
    sorted.Sort(bits, keys);
    for (size_t i = 0; i < sorted.count; ++i) {
      const size_t lane = sorted.LaneOf(i);
      const detail::KeyedSlot keyed = detail::Keyed(keys[lane], first + lane);
      if (keyed > list_.worst()) return;
      list_.AddSorted(keyed);
    }
  }

  // The lanes that can have one of the `room` least keys. Lanes are divided
  // into groups, and the limit is the least key of the group whose least key is
  // the `room`-th in order.
  HWY_INLINE uint64_t OfLeastGroups(const float* keys, size_t end) const {
    const hn::CappedTag<float, kGroups> d;
    HWY_ALIGN float least[kGroups];
    for (size_t g = 0; g < kGroups; g += hn::Lanes(d)) {
      auto of_group = hn::Load(d, keys + g);
      for (size_t i = kGroups + g; i < end; i += kGroups) {
        of_group = hn::Min(of_group, hn::Load(d, keys + i));
      }
      hn::Store(of_group, d, least + g);
    }
    float limit = kInf;
    for (float one : least) {
      const auto from = hn::Set(d, one);
      size_t not_above = 0;
      for (size_t g = 0; g < kGroups; g += hn::Lanes(d)) {
        not_above +=
            hwy::PopCount(LaneBits(d, hn::Le(hn::Load(d, least + g), from)));
      }
      if (not_above >= search_.room) limit = HWY_MIN(limit, one);
    }
    return LanesUpTo(limit, keys, end);
  }

  HWY_INLINE uint64_t LanesUpTo(float limit, const float* keys,
                                size_t end) const {
    const WordTag<float> d;
    uint64_t bits = 0;
    for (size_t i = 0; i < end; i += hn::Lanes(d)) {
      const auto key = hn::Load(d, keys + i);
      bits |= LaneBits(d, hn::Le(key, hn::Set(d, limit))) << i;
    }
    return bits;
  }

  // Writes the keys of a block's nodes or objects. Returns a bit for each that
  // exists, has a wanted mask, is not beyond the limit, and was not found
  // before. If one within the limit does not exist or has no wanted mask, its
  // key becomes +inf.
  // kDims is as in SquaredDistance().
  template <size_t kDims>
  HWY_NOINLINE uint64_t ReadKeysOf(size_t level, size_t block, size_t end,
                                   float* keys) const {
    const detail::BvhLevel& nodes = search_.levels->level[level];
    const size_t first = block * detail::kBlockObjects;
    uint64_t wanted = nodes.present[block];
    if (has_masks_) wanted &= MaskBits(nodes.masks + first, search_.mask);
    const WordTag<float> d;
    const auto limit = hn::Set(d, detail::KeyOf(list_.worst()));
    const auto from =
        hn::Set(d, level == 0 ? detail::KeyOf(search_.from) : 0.0f);
    const float* const floats = nodes.Plane(block, 0);
    if (search_.is_exclusive && level == 0) wanted &= ~EqualLanes(floats, end);
    uint64_t bits = 0;
    for (size_t i = 0; i < end; i += hn::Lanes(d)) {
      const auto key = SquaredDistance<kDims>(d, floats + i, search_.box);
      const auto is_found = hn::And(hn::Le(key, limit), hn::Ge(key, from));
      bits |= LaneBits(d, is_found) << i;
      hn::Store(key, d, keys + i);
    }
    for (uint64_t others = bits & ~wanted; others != 0; others &= others - 1) {
      keys[hwy::Num0BitsBelowLS1Bit_Nonzero64(others)] = kInf;
    }
    return bits & wanted;
  }

  // The lanes of the objects whose box is that of the query.
  HWY_INLINE uint64_t EqualLanes(const float* floats, size_t end) const {
    const WordTag<float> d;
    const detail::NearBox& box = search_.box;
    uint64_t bits = ~uint64_t{0};
    const auto keep = [&](size_t plane, float value) {
      const float* const values = floats + plane * detail::kBlockObjects;
      uint64_t equal = 0;
      for (size_t i = 0; i < end; i += hn::Lanes(d)) {
        const auto its = hn::Load(d, values + i);
        equal |= LaneBits(d, hn::Eq(its, hn::Set(d, value))) << i;
      }
      bits &= equal;
    };
    for (size_t k = 0; k < box.dims; ++k) keep(k, box.low[k]);
    for (size_t k = 0; k < box.dims && box.max_plane != 0; ++k) {
      keep(box.max_plane + k, box.high[k]);
    }
    return bits;
  }

  HWY_INLINE uint64_t ReadKeys(size_t level, size_t block, size_t end,
                               float* keys) const {
    if (search_.box.max_plane == 0) {
      return ReadKeysOf<0>(level, block, end, keys);
    }
    return search_.box.dims == 2 ? ReadKeysOf<2>(level, block, end, keys)
                                 : ReadKeysOf<3>(level, block, end, keys);
  }

  // The lane of the least key. The lane replaces the lowest bits of each key,
  // so keys that differ only there count as equal. A minimum of integers takes
  // a third of the time of a minimum of floats.
  static HWY_INLINE size_t AboutLeast(const float* keys, size_t end) {
    const WordTag<float> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const auto lanes = hn::Set(du, kLaneBits);
    auto least = hn::Set(du, ~uint32_t{0});
    for (size_t i = 0; i < end; i += hn::Lanes(d)) {
      const auto key = hn::BitCast(du, hn::Load(d, keys + i));
      const auto lane = hn::Iota(du, static_cast<uint32_t>(i));
      least = hn::Min(least, hn::Or(hn::AndNot(lanes, key), lane));
    }
    return hn::GetLane(hn::MinOfLanes(du, least)) & kLaneBits;
  }

  const detail::NearestSearch& search_;
  const bool has_masks_;
  const bool is_many_;
  NearestList list_;
};

inline size_t FindNearest(const detail::NearestSearch& search) {
  return NearestFinder(search).Find();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
