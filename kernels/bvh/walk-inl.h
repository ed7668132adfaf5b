// The walk of a query from the root of a BVH to the objects that survive.
#if defined(HALFSPACE_KERNELS_BVH_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_WALK_INL_H_
#undef HALFSPACE_KERNELS_BVH_WALK_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_WALK_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/bvh/block.h"
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/curve-inl.h"
#include "kernels/bvh/shape.h"
#include "kernels/prefetch.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Calls write(i, bit) for the i-th set bit: for up to four bits without a
// branch, so that places 0 ... 3 are written even with fewer.
template <class Write>
HWY_INLINE void ForFewBits(uint64_t bits, const Write& write) {
  for (size_t i = 0; i < 4; ++i) {
    write(i, hwy::Num0BitsBelowLS1Bit_Nonzero64(bits | uint64_t{1} << 63));
    bits &= bits - 1;
  }
  for (size_t i = 4; bits != 0; ++i) {
    write(i, hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
    bits &= bits - 1;
  }
}

// Writes ids[i] for every bit i. There is room for 64.
HWY_INLINE uint32_t* WriteIds(uint64_t bits, const uint32_t* ids,
                              uint32_t* to) {
#if HALFSPACE_MASKED_COMPARES
  const hn::CappedTag<uint32_t, 16> d;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto some = static_cast<uint16_t>(bits >> i);
    hn::StoreU(hn::Compress(hn::LoadU(d, ids + i), hn::Mask<decltype(d)>{some}),
               d, to);
    to += hwy::PopCount(uint64_t{some});
  }
  return to;
#else
  ForFewBits(bits, [&](size_t i, size_t bit) HWY_ATTR { to[i] = ids[bit]; });
  return to + hwy::PopCount(bits);
#endif
}

// Walks from the root to the objects that survive, in two steps: nodes are
// tested depth first, and leaves that survive are put on a list, so that all of
// them can be prefetched before the first is read. The list has the leaves of
// several queries. Leaves, if given, derives from this and has queries of its
// own: it has VisitLeaves(), which takes a list, and WantedNodes().
template <size_t kAxes, bool kHasMax, bool kWrites, class Leaves = void>
class Walker {
 public:
  static constexpr size_t kPlanes = kBlockPlanes<kAxes, kHasMax>;

  explicit Walker(const detail::Walk& walk)
      : walk_(walk),
        levels_(*walk.levels),
        has_masks_(levels_.level[0].masks != nullptr && ~walk.mask != 0),
        reads_codes_(
            levels_.codes != nullptr &&
            (walk.shape == nullptr || walk.shape->instead == nullptr)) {}

  void Run() {
    for (size_t q = 0; q < walk_.query_count; ++q) {
      ReadQuery<kAxes, kHasMax>(walk_.queries + q * kPlanes,
                                queries_[q - first_query_]);
      if (!Visit(levels_.count - 1, PlaceOf(q - first_query_))) return;
      const size_t walkers = q + 1 - first_query_;
      if (walkers < detail::kWalkers && q + 1 < walk_.query_count) continue;
      if (!VisitList() || (kWrites && !EndQueries(walkers))) return;
      first_query_ = q + 1;
      query_ = 0;
      encoded_ = kNone;
    }
  }

 protected:
  static constexpr bool kHasLeaves = !std::is_void_v<Leaves>;
  // Leaves are read when there are so many on the list, and those of one block
  // of nodes more. With 64, prefetched lines evict each other, and a query of a
  // million boxes takes 1.1 times as long.
  static constexpr size_t kManyLeaves = 16;
  // From so many survivors in a block on, those inside the query are looked
  // for: a query that is not larger than its nodes has none.
  static constexpr size_t kManyKept = 8;

  static uint32_t PlaceOf(size_t query) {
    return static_cast<uint32_t>(query << detail::kQueryShift);
  }
  static size_t BlockOf(uint32_t place) { return place & detail::kBlockMask; }
  static size_t QueryOf(uint32_t place) { return place >> detail::kQueryShift; }
  static bool IsInside(uint32_t place) {
    return (place & detail::kInsideBit) != 0;
  }
  // The first of its objects or nodes.
  static size_t FirstOf(uint32_t place) {
    return BlockOf(place) * detail::kBlockObjects;
  }

  // A block of a level, and what survives below it.
  bool Visit(size_t level, uint32_t place) {
    if (level == 0) return VisitOnlyLeaf(place);
    uint64_t kept;
    uint64_t inside = 0;
    if (IsInside(place)) {
      kept = levels_.level[level].present[BlockOf(place)];
    } else {
      kept = Filter(level, place, TestFloatsOf(level, place));
      if (kept == 0) return true;
      inside = Inside(level, place, kept);
      if constexpr (!kWrites) {
        if (inside != 0) Count(level, place, inside);
        kept &= ~inside;
      }
    }
    const uint32_t first =
        (place & ~detail::kBlockMask) | static_cast<uint32_t>(FirstOf(place));
    if (level == 1) return ListLeaves(first, kept, inside);
    for (; kept != 0; kept &= kept - 1) {
      const size_t bit = hwy::Num0BitsBelowLS1Bit_Nonzero64(kept);
      const uint32_t is_inside = inside >> bit & 1;
      if (!Visit(level - 1, (first + static_cast<uint32_t>(bit)) |
                                is_inside * detail::kInsideBit)) {
        return false;
      }
    }
    return true;
  }

  // Of a world without nodes.
  HWY_INLINE bool VisitOnlyLeaf(uint32_t place) {
    if constexpr (kHasLeaves) {
      list_[list_size_++] = place;
      return true;
    } else {
      if (kWrites && !EndQueries(QueryOf(place))) return false;
      const uint64_t kept = Filter(0, place, TestFloatsOf(0, place));
      return kept == 0 || Take(place, kept);
    }
  }

  HWY_INLINE bool ListLeaves(uint32_t first, uint64_t kept, uint64_t inside) {
    uint32_t* const to = list_ + list_size_;
    ForFewBits(kept, [&](size_t n, size_t bit) HWY_ATTR {
      to[n] = first + static_cast<uint32_t>(bit);
    });
    const size_t leaves = hwy::PopCount(kept);
    if (kWrites && inside != 0) {
      for (size_t n = 0; n < leaves; ++n) {
        const uint64_t bit = inside >> (to[n] % detail::kBlockObjects) & 1;
        to[n] |= static_cast<uint32_t>(bit) * detail::kInsideBit;
      }
    }
    if (levels_.level[0].is_prefetched) {
      for (size_t n = 0; n < leaves; ++n) PrefetchLeaf(to[n]);
    }
    list_size_ += leaves;
    return list_size_ < kManyLeaves || VisitList();
  }

  // Reads the leaves on the list.
  bool VisitList() {
    const size_t size = list_size_;
    if (size == 0) return true;
    list_size_ = 0;
    if constexpr (kHasLeaves) {
      return static_cast<Leaves*>(this)->VisitLeaves(list_, size);
    } else {
      return VisitLeaves(size);
    }
  }

  HWY_INLINE uint64_t TestFloatsOf(size_t level, uint32_t place) const {
    const detail::BvhLevel& tested = levels_.level[level];
    const detail::WalkShape* const shape = walk_.shape;
    if (shape != nullptr && shape->instead != nullptr) {
      return shape->instead(*shape, tested, BlockOf(place),
                            tested.present[BlockOf(place)]);
    }
    return TestFloats<kAxes, kHasMax>(tested, BlockOf(place),
                                      queries_[QueryOf(place)]);
  }

  HWY_NOINLINE uint64_t TestObjects(uint32_t place) const {
    return TestFloatsOf(0, place);
  }

  // Those of `kept` that have what a query asks for beside its planes.
  HWY_INLINE uint64_t Filter(size_t level, uint32_t place, uint64_t kept) {
    if constexpr (kHasLeaves) {
      kept &= static_cast<Leaves*>(this)->WantedNodes(level, place);
    }
    if (kept != 0 && has_masks_) {
      kept &= MaskBits(levels_.level[level].masks + FirstOf(place), walk_.mask);
    }
    if (kept != 0 && walk_.shape != nullptr &&
        walk_.shape->touching != nullptr) {
      kept = walk_.shape->touching(*walk_.shape, levels_.level[level],
                                   BlockOf(place), kept);
    }
    return kept;
  }

  // The nodes of `kept` all of whose objects survive.
  HWY_INLINE uint64_t Inside(size_t level, uint32_t place, uint64_t kept) {
    if constexpr (kHasMax && !kHasLeaves) {
      if (has_masks_) return 0;
      if (kWrites && hwy::PopCount(kept) < kManyKept) return 0;
      const detail::WalkShape* const shape = walk_.shape;
      if (shape != nullptr && shape->inside == nullptr) return 0;
      const detail::BvhLevel& nodes = levels_.level[level];
      const size_t block = BlockOf(place);
      uint64_t candidates = kept & nodes.regular[block];
      if (candidates != 0) {
        candidates &= InsideBits<kAxes>(nodes, block, queries_[QueryOf(place)]);
      }
      if (candidates != 0 && shape != nullptr) {
        candidates = shape->inside(*shape, nodes, block, candidates);
      }
      return candidates;
    }
    return 0;
  }

  // Adds the objects of the nodes inside the query, without a visit.
  void Count(size_t level, uint32_t place, uint64_t inside) {
    const detail::BvhLevel& nodes = levels_.level[level];
    const size_t objects_of_node = size_t{1} << (6 * level);
    size_t objects = hwy::PopCount(inside) * objects_of_node;
    // The last node may have fewer.
    const size_t last = nodes.size - 1;
    if (last / detail::kBlockObjects == BlockOf(place) &&
        (inside >> (last % detail::kBlockObjects) & 1) != 0) {
      objects -= nodes.size * objects_of_node - levels_.level[0].size;
    }
    walk_.counts[first_query_ + QueryOf(place)] += objects;
  }

  template <size_t kCount, typename T>
  static HWY_INLINE void PrefetchAll(const T* values) {
    for (size_t i = 0; i < kCount; i += 64 / sizeof(T)) {
      kernels::Prefetch(values + i);
    }
  }

  void PrefetchLeaf(uint32_t place) const {
    if constexpr (kHasLeaves) return;
    if (!IsInside(place)) {
      constexpr size_t kValues = kPlanes * detail::kBlockObjects;
      if (reads_codes_) {
        PrefetchAll<kValues>(Codes(place));
      } else {
        PrefetchAll<kValues>(levels_.level[0].Plane(BlockOf(place), 0));
      }
    }
  }

  const int16_t* Codes(uint32_t place) const {
    return levels_.codes + FirstOf(place) * kPlanes;
  }

  bool VisitLeaves(size_t size) {
    Unsure unsure[kManyLeaves + detail::kBlockObjects];
    size_t unsure_count = 0;
    for (size_t i = 0; i < size; ++i) {
      const uint32_t place = list_[i];
      const size_t query = QueryOf(place);
      if (query != encoded_) {
        if (unsure_count != 0 && !Resolve(unsure, unsure_count)) return false;
        unsure_count = 0;
        if (kWrites && !EndQueries(query)) return false;
        encoded_ = query;
        if (reads_codes_) {
          EncodeQuery<kAxes, kHasMax>(*levels_.map, queries_[query], codes_);
        }
      }
      uint64_t kept;
      if (IsInside(place)) {
        kept = levels_.level[0].present[BlockOf(place)];
      } else if (!reads_codes_) {
        kept = Filter(0, place, TestObjects(place));
      } else {
        const LeafBits bits = TestCodes<kAxes, kPlanes>(Codes(place), codes_);
        kept = bits.kept & levels_.level[0].present[BlockOf(place)];
        kept = Filter(0, place, kept);
        unsure[unsure_count] = {place, bits.unsure & kept};
        unsure_count += (bits.unsure & kept) != 0;
        kept &= ~bits.unsure;
      }
      if (kept != 0 && !Take(place, kept)) return false;
    }
    return unsure_count == 0 || Resolve(unsure, unsure_count);
  }

  bool EndQueries(size_t end) {
    for (; query_ < end; ++query_) {
      if (!walk_.ids->end_of_query(*walk_.ids, first_query_ + query_)) {
        return false;
      }
    }
    return true;
  }

  HWY_INLINE bool Take(uint32_t place, uint64_t bits) {
    if constexpr (kWrites) {
      detail::WalkIds& ids = *walk_.ids;
      if (static_cast<size_t>(ids.end - ids.next) < detail::kBlockObjects)
          [[unlikely]] {
        if (!ids.make_room(ids)) return false;
      }
      ids.next = WriteIds(bits, levels_.ids + FirstOf(place), ids.next);
    } else {
      walk_.counts[first_query_ + QueryOf(place)] += hwy::PopCount(bits);
    }
    return true;
  }

  struct Unsure {
    uint32_t place;
    uint64_t bits;
  };

  // The floats say which of the unsure survive.
  bool Resolve(const Unsure* unsure, size_t count) {
    for (size_t u = 0; u < count; ++u) {
      if (!Take(unsure[u].place, KeptOf(unsure[u].place, unsure[u].bits))) {
        return false;
      }
    }
    return true;
  }

  // Of `bits`. One object after another, or, from so many on, the block at
  // once: the same time.
  uint64_t KeptOf(uint32_t place, uint64_t bits) const {
    constexpr size_t kFew = 6;
    const PlaneQuery& query = queries_[QueryOf(place)];
    const detail::BvhLevel& objects = levels_.level[0];
    const size_t block = BlockOf(place);
    if (hwy::PopCount(bits) > kFew) {
      return bits & TestObjects(place);
    }
    uint64_t kept = 0;
    for (; bits != 0; bits &= bits - 1) {
      const size_t bit = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      bool rejects = false;
      for (size_t k = 0; k < kAxes; ++k) {
        rejects |= objects.Plane(block, k)[bit] > query.values[k];
        if constexpr (kHasMax) {
          rejects |=
              objects.Plane(block, kAxes + k)[bit] < query.values[kAxes + k];
        }
      }
      kept |= uint64_t{!rejects} << bit;
    }
    return kept;
  }

  static constexpr size_t kNone = ~size_t{0};

  const detail::Walk& walk_;
  const detail::BvhLevels& levels_;
  const bool has_masks_;
  const bool reads_codes_;
  size_t list_size_ = 0;
  size_t first_query_ = 0;  // of those that walk together
  size_t query_ = 0;        // after the first, whose ids are written
  size_t encoded_ = kNone;  // the query that codes_ is of
  QueryCodes codes_;
  PlaneQuery queries_[detail::kWalkers];
  uint32_t list_[kManyLeaves + detail::kBlockObjects];
};

template <size_t kAxes, bool kHasMax, bool kWrites>
void RunWalk(const detail::Walk& walk) {
  Walker<kAxes, kHasMax, kWrites>(walk).Run();
}

template <size_t kAxes, bool kHasMax>
constexpr detail::BvhKernels::OfPlanes MakeBvhKernelsOf() {
  return {&FindCenters<kAxes, kHasMax>, &FindPlaces<kAxes, kHasMax>,
          &EncodeBlocks<kAxes, kHasMax>, &RunWalk<kAxes, kHasMax, true>,
          &RunWalk<kAxes, kHasMax, false>};
}

// A simplex has three axes or more.
template <size_t kAxes>
constexpr detail::BvhKernels MakeBvhKernels() {
  detail::BvhKernels kernels{};
  if constexpr (kAxes > 2) kernels.minima = MakeBvhKernelsOf<kAxes, false>();
  kernels.all = MakeBvhKernelsOf<kAxes, true>();
  return kernels;
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_WALK_INL_H_
