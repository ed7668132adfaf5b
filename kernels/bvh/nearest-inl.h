// The objects with the least keys: into the nearest node first, and into others
// while they can have what is nearer than the last of those found. A node's key
// and first slot are at most those of all objects in it, so what is found is
// exact, ties included, and one node of each level is remembered at a time.
#if defined(HALFSPACE_KERNELS_BVH_NEAREST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
#undef HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
#endif

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "hwy/highway.h"
#include "kernels/bvh/block.h"
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/nearest.h"
#include "kernels/bvh/shapes-inl.h"
#include "kernels/bvh/sorted-inl.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

class NearestFinder {
 public:
  explicit NearestFinder(const detail::NearestSearch& search)
      : search_(search),
        has_masks_(search.levels->level[0].masks != nullptr &&
                   ~search.mask != 0),
        is_many_(search.room >= detail::kBlockObjects),
        worst_(Keyed(search.limit, ~uint32_t{0})) {}

  size_t Find() {
    Visit(search_.levels->count - 1, 0);
    if (is_many_) SortMany();
    return count_;
  }

 private:
  static constexpr float kInf = std::numeric_limits<float>::infinity();

  static detail::KeyedSlot Keyed(float key, size_t slot) {
    return uint64_t{std::bit_cast<uint32_t>(key)} << 32 | slot;
  }
  static float KeyOf(detail::KeyedSlot keyed) {
    return std::bit_cast<float>(static_cast<uint32_t>(keyed >> 32));
  }

  void Visit(size_t level, size_t block) {
    HWY_ALIGN float keys[detail::kBlockObjects];
    // Of the vectors with nodes or objects: the others are not read.
    const size_t lanes = hn::Lanes(WordTag<float>());
    const size_t size =
        search_.levels->level[level].size - block * detail::kBlockObjects;
    const size_t end =
        HWY_MIN(detail::kBlockObjects, (size + lanes - 1) / lanes * lanes);
    uint64_t bits = ReadKeys(level, block, end, keys);
    if (bits == 0) return;
    if (level == 0 && is_many_) {
      for (; bits != 0; bits &= bits - 1) {
        const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
        AddToMany(Keyed(keys[lane], block * detail::kBlockObjects + lane));
      }
      return;
    }
    float key;
    size_t lane = TakeLeast(keys, end, key);
    for (;;) {
      const size_t place = block * detail::kBlockObjects + lane;
      const detail::KeyedSlot keyed = Keyed(key, place << (6 * level));
      // Also where none is left, as no limit is infinite.
      if (keyed > worst_) return;
      if (level == 0) {
        if (keyed >= search_.from) {
          AddToFew(keyed);
          if (search_.room == 1) return;
        }
        lane = TakeLeast(keys, end, key);
      } else {
        lane = TakeLeast(keys, end, key);
        if (key <= KeyOf(worst_)) {
          PrefetchPlanes(search_.levels->level[level - 1],
                         block * detail::kBlockObjects + lane);
        }
        Visit(level - 1, place);
      }
    }
  }

  // From i on: never a NaN, and never -0.
  template <class D>
  HWY_INLINE hn::Vec<D> SquaredDistanceOf(D d, const detail::BvhLevel& nodes,
                                          size_t block, size_t i) const {
    const detail::NearBox& box = search_.box;
    auto sum = hn::Zero(d);
    for (size_t k = 0; k < box.dims; ++k) {
      auto gap = GreaterOf(hn::Sub(hn::LoadU(d, nodes.Plane(block, k) + i),
                                   hn::Set(d, box.high[k])),
                           hn::Zero(d));
      if (box.max_plane != 0) {
        const float* const maxima = nodes.Plane(block, box.max_plane + k);
        gap = GreaterOf(
            hn::Sub(hn::Set(d, box.low[k]), hn::LoadU(d, maxima + i)), gap);
      }
      sum = hn::Add(sum, hn::Mul(gap, gap));
    }
    return sum;
  }

  // Writes the keys of a block's nodes, or of its objects that were not found
  // before; +inf of those beyond the limit. Returns a bit for each of the
  // others.
  HWY_INLINE uint64_t ReadKeys(size_t level, size_t block, size_t end,
                               float* keys) const {
    const detail::BvhLevel& nodes = search_.levels->level[level];
    const size_t first = block * detail::kBlockObjects;
    uint64_t wanted = nodes.present[block];
    if (has_masks_) wanted &= MaskBits(nodes.masks + first, search_.mask);
    const WordTag<float> d;
    const auto limit = hn::Set(d, KeyOf(worst_));
    const auto from = hn::Set(d, level == 0 ? KeyOf(search_.from) : 0.0f);
    const auto inf = hn::Set(d, kInf);
    uint64_t bits = 0;
    for (size_t i = 0; i < end; i += hn::Lanes(d)) {
      const auto key = SquaredDistanceOf(d, nodes, block, i);
      const auto is_found = hn::And(hn::Le(key, limit), hn::Ge(key, from));
      bits |= LaneBits(d, is_found) << i;
      hn::Store(hn::IfThenElse(is_found, key, inf), d, keys + i);
    }
    for (uint64_t others = bits & ~wanted; others != 0; others &= others - 1) {
      keys[hwy::Num0BitsBelowLS1Bit_Nonzero64(others)] = kInf;
    }
    return bits & wanted;
  }

  // The least key and its first lane, which is not taken again.
  static HWY_INLINE size_t TakeLeast(float* keys, size_t end, float& key) {
    const WordTag<float> d;
    auto least = hn::Load(d, keys);
    for (size_t i = hn::Lanes(d); i < end; i += hn::Lanes(d)) {
      least = hn::Min(least, hn::Load(d, keys + i));
    }
    least = hn::MinOfLanes(d, least);
    key = hn::GetLane(least);
    uint64_t bits = 0;
    for (size_t i = 0; i < end; i += hn::Lanes(d)) {
      bits |= LaneBits(d, hn::Eq(hn::Load(d, keys + i), least)) << i;
    }
    if (bits == 0) {  // as Highway's plain target starts from the largest float
      key = kInf;
      return 0;
    }
    const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
    keys[lane] = kInf;
    return lane;
  }

  // Few are a sorted list.
  void AddToFew(detail::KeyedSlot keyed) {
    detail::KeyedSlot* const found = search_.found;
    size_t i = count_ < search_.room ? count_++ : count_ - 1;
    for (; i > 0 && found[i - 1] > keyed; --i) found[i] = found[i - 1];
    found[i] = keyed;
    if (count_ == search_.room) worst_ = found[count_ - 1];
  }

  // Many are in no order until there is no more room, and then a heap whose
  // first is the greatest, which the next replaces.
  void AddToMany(detail::KeyedSlot keyed) {
    if (keyed < search_.from || keyed > worst_) return;
    if (count_ < search_.room) {
      search_.found[count_++] = keyed;
      if (count_ < search_.room) return;
      for (size_t i = count_ / kChildren + 1; i-- > 0;) {
        SiftDown(i, search_.found[i]);
      }
    } else {
      SiftDown(0, keyed);
    }
    worst_ = search_.found[0];
  }

  // Puts it to place i of the heap, or below. Four children halve the levels,
  // and are neighbours in memory.
  static constexpr size_t kChildren = 4;
  void SiftDown(size_t i, detail::KeyedSlot keyed) const {
    detail::KeyedSlot* const found = search_.found;
    for (;;) {
      size_t child = kChildren * i + 1;
      if (child >= count_) break;
      const size_t end = HWY_MIN(child + kChildren, count_);
      size_t most = child;
      detail::KeyedSlot most_keyed = found[child];
      while (++child < end) {  // selects, as branches would be mispredicted
        const bool is_more = found[child] > most_keyed;
        most = is_more ? child : most;
        most_keyed = is_more ? found[child] : most_keyed;
      }
      if (most_keyed <= keyed) break;
      found[i] = most_keyed;
      i = most;
    }
    found[i] = keyed;
  }

  void SortMany() const {
    detail::KeyedSlot differing = 1;
    for (size_t i = 1; i < count_; ++i) {
      differing |= search_.found[i] ^ search_.found[0];
    }
    SortMany(
        0, count_,
        63 - static_cast<int>(hwy::Num0BitsAboveMS1Bit_Nonzero64(differing)));
  }

  // By one bit after another, from the highest that is not the same in all.
  // Each pass is in the order of memory and has no branch to mispredict: a heap
  // of a million takes two to three times as long to sort.
  void SortMany(size_t begin, size_t end, int bit) const {
    detail::KeyedSlot* const found = search_.found;
    while (end - begin > 16 && bit >= 0) {
      size_t middle = begin;
      for (size_t i = begin; i < end; ++i) {
        const detail::KeyedSlot keyed = found[i];
        found[i] = found[middle];
        found[middle] = keyed;
        middle += (~keyed >> bit) & 1;
      }
      --bit;
      SortMany(begin, middle, bit);
      begin = middle;
    }
    for (size_t i = begin; i < end; ++i) {
      const detail::KeyedSlot keyed = found[i];
      size_t to = i;
      for (; to > begin && found[to - 1] > keyed; --to) {
        found[to] = found[to - 1];
      }
      found[to] = keyed;
    }
  }

  const detail::NearestSearch& search_;
  const bool has_masks_;
  const bool is_many_;
  size_t count_ = 0;
  detail::KeyedSlot worst_;  // none beyond it is found
};

inline size_t FindNearest(const detail::NearestSearch& search) {
  return NearestFinder(search).Find();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_NEAREST_INL_H_
