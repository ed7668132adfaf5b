// From the root to the objects that survive: level by level, a few blocks at a
// time. A block's survivors are appended to a list without a branch, because
// which survive cannot be predicted, and all of them can be prefetched before
// the first is read.
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

// Leaves, if given, derives from this and walks with queries of its own: it has
// VisitLeaves(), which takes what VisitObjects() does, and WantedNodes().
template <size_t kAxes, bool kHasMax, bool kWrites, class Leaves = void>
class Walker {
 public:
  static constexpr size_t kPlanes = kBlockPlanes<kAxes, kHasMax>;
  using Block = detail::Block<kPlanes>;

  explicit Walker(const detail::Walk& walk)
      : walk_(walk),
        levels_(*walk.levels),
        has_masks_(levels_.level[0].masks != nullptr && ~walk.mask != 0) {}

  void Run() {
    for (size_t first = 0; first < walk_.query_count;
         first += detail::kWalkers) {
      const size_t count = HWY_MIN(detail::kWalkers, walk_.query_count - first);
      uint32_t roots[detail::kWalkers];
      for (size_t q = 0; q < count; ++q) {
        ReadQuery<kAxes, kHasMax>(walk_.queries + (first + q) * kPlanes,
                                  queries_[q]);
        roots[q] = static_cast<uint32_t>(q << detail::kQueryShift);
      }
      first_query_ = first;
      query_ = 0;
      if (!Visit(levels_.count - 1, roots, count)) return;
      if (kWrites && !EndQueries(count)) return;
    }
  }

 protected:
  static constexpr bool kHasLeaves = !std::is_void_v<Leaves>;
  // A chunk of blocks is tested before their survivors are. Leaves need stack.
  static constexpr size_t kChunk = kHasLeaves ? 8 : 16;
  // From so many survivors in a block on, those inside the query are looked
  // for: a query that is not larger than its nodes has none.
  static constexpr size_t kManyKept = 8;

  static const Block& BlockOf(const detail::BvhLevel& level, uint32_t place) {
    return reinterpret_cast<const Block*>(
        level.blocks)[place & detail::kBlockMask];
  }
  // The first of its objects or nodes.
  static size_t FirstOf(uint32_t place) {
    return size_t{place & detail::kBlockMask} * detail::kBlockObjects;
  }
  static size_t QueryOf(uint32_t place) { return place >> detail::kQueryShift; }

  bool Visit(size_t level, const uint32_t* places, size_t count) {
    if (level == 0) {
      if constexpr (kHasLeaves) {
        return static_cast<Leaves*>(this)->VisitLeaves(places, count);
      } else {
        return VisitObjects(places, count);
      }
    }
    uint32_t* const list = lists_[level - 1];
    for (size_t begin = 0; begin < count; begin += kChunk) {
      const size_t end = HWY_MIN(begin + kChunk, count);
      uint32_t* to = list;
      for (size_t i = begin; i < end; ++i) {
        const uint32_t place = places[i];
        uint64_t kept;
        uint64_t inside = 0;
        if ((place & detail::kInsideBit) != 0) {
          kept = levels_.level[level].present[place & detail::kBlockMask];
        } else {
          kept = Filter(level, place, Test(level, place).kept);
          inside = Inside(level, place, kept);
          if constexpr (!kWrites) {
            if (inside != 0) Count(level, place, inside);
            kept &= ~inside;
          }
        }
        const uint32_t first = (place & ~detail::kBlockMask) |
                               (place & detail::kBlockMask) *
                                   static_cast<uint32_t>(detail::kBlockObjects);
        ForFewBits(kept, [&](size_t n, size_t bit) HWY_ATTR {
          to[n] = first + static_cast<uint32_t>(bit);
        });
        const size_t survivors = hwy::PopCount(kept);
        if (kWrites && inside != 0) {
          for (size_t n = 0; n < survivors; ++n) {
            const uint64_t bit = inside >> (to[n] % detail::kBlockObjects) & 1;
            to[n] |= static_cast<uint32_t>(bit) * detail::kInsideBit;
          }
        }
        if (levels_.level[level - 1].is_prefetched) {
          for (size_t n = 0; n < survivors; ++n) {
            PrefetchBlock(levels_.level[level - 1], to[n], level == 1);
          }
        }
        to += survivors;
      }
      if (!Visit(level - 1, list, static_cast<size_t>(to - list))) return false;
    }
    return true;
  }

  // By the codes.
  HWY_INLINE BlockBits Test(size_t level, uint32_t place) const {
    const detail::BvhLevel& blocks = levels_.level[level];
    const detail::WalkShape* const shape = walk_.shape;
    if (shape != nullptr && shape->instead != nullptr) {
      return {shape->instead(*shape, blocks, FirstOf(place),
                             blocks.present[place & detail::kBlockMask]),
              0};
    }
    return TestBlock<kAxes, kHasMax>(BlockOf(blocks, place),
                                     queries_[QueryOf(place)]);
  }

  // Those of `kept` that have what a query asks for beside its planes.
  HWY_INLINE uint64_t Filter(size_t level, uint32_t place, uint64_t kept) {
    if constexpr (kHasLeaves) {
      kept &= static_cast<Leaves*>(this)->WantedNodes(level, place);
    }
    if (kept != 0 && has_masks_) {
      kept &= MaskBits(levels_.level[level].masks + FirstOf(place), walk_.mask);
    }
    if (kept != 0 && level != 0 && walk_.shape != nullptr &&
        walk_.shape->instead == nullptr) {
      kept = walk_.shape->touching(*walk_.shape, levels_.level[level],
                                   FirstOf(place), kept);
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
      uint64_t candidates =
          kept & levels_.level[level].regular[place & detail::kBlockMask];
      // Without a second encoding of the query where there can be none.
      if (candidates != 0) candidates &= InsideQuery(level, place);
      if (candidates != 0 && shape != nullptr) {
        candidates = shape->inside(*shape, levels_.level[level], FirstOf(place),
                                   candidates);
      }
      return candidates;
    }
    return 0;
  }

  uint64_t InsideQuery(size_t level, uint32_t place) const {
    const WalkQuery& query = queries_[QueryOf(place)];
    WalkQuery inverse;
    for (size_t l = 0; l < detail::BlockScale::kLanes; ++l) {
      inverse.lanes[l] = -query.lanes[l ^ detail::BlockScale::kMaxLane];
    }
    return InsideBits<kAxes>(BlockOf(levels_.level[level], place), inverse);
  }

  // Adds the objects of the nodes inside the query, without a visit.
  void Count(size_t level, uint32_t place, uint64_t inside) {
    const detail::BvhLevel& nodes = levels_.level[level];
    const size_t objects_of_node = size_t{1} << (6 * level);
    size_t objects = hwy::PopCount(inside) * objects_of_node;
    // The last node may have fewer.
    const size_t last = nodes.size - 1;
    if (last / detail::kBlockObjects == (place & detail::kBlockMask) &&
        (inside >> (last % detail::kBlockObjects) & 1) != 0) {
      objects -= nodes.size * objects_of_node - levels_.level[0].size;
    }
    walk_.counts[first_query_ + QueryOf(place)] += objects;
  }

  void PrefetchBlock(const detail::BvhLevel& level, uint32_t place,
                     bool has_ids) const {
    if (kHasLeaves && has_ids) return;
    if ((place & detail::kInsideBit) == 0) {
      const auto* block = reinterpret_cast<const char*>(&BlockOf(level, place));
      for (size_t b = 0; b < sizeof(Block); b += 64) {
        kernels::Prefetch(block + b);
      }
    }
    if (!kWrites || !has_ids) return;
    const uint32_t* ids = levels_.ids + size_t{place & detail::kBlockMask} *
                                            detail::kBlockObjects;
    for (size_t i = 0; i < detail::kBlockObjects; i += 16) {
      kernels::Prefetch(ids + i);
    }
  }

  bool VisitObjects(const uint32_t* places, size_t count) {
    for (size_t begin = 0; begin < count; begin += kChunk) {
      const size_t end = HWY_MIN(begin + kChunk, count);
      Unsure unsure[kChunk];
      size_t unsure_count = 0;
      for (size_t i = begin; i < end; ++i) {
        const uint32_t place = places[i];
        const size_t query = QueryOf(place);
        if (kWrites && query != query_) {
          if (!Resolve(unsure, unsure_count) || !EndQueries(query)) {
            return false;
          }
          unsure_count = 0;
        }
        if ((place & detail::kInsideBit) != 0) {
          if (!Take(place,
                    levels_.level[0].present[place & detail::kBlockMask])) {
            return false;
          }
          continue;
        }
        BlockBits bits = Test(0, place);
        bits.kept = Filter(0, place, bits.kept);
        if (walk_.shape != nullptr && walk_.shape->touching != nullptr) {
          bits.unsure = bits.kept;
          PrefetchFloats(place, bits.kept);
        }
        bits.unsure &= bits.kept;
        unsure[unsure_count] = {place, bits.unsure};
        unsure_count += bits.unsure != 0;
        if (!Take(place, bits.kept & ~bits.unsure)) return false;
      }
      if (unsure_count != 0 && !Resolve(unsure, unsure_count)) return false;
    }
    return true;
  }

  // Shapes have many unsure objects, one of which would wait for the other.
  void PrefetchFloats(uint32_t place, uint64_t bits) const {
    constexpr size_t kLine = 64 / sizeof(float);
    for (size_t i = 0; i < detail::kBlockObjects; i += kLine) {
      if ((bits >> i & 0xFFFF) == 0) continue;
      for (size_t p = 0; p < kPlanes; ++p) {
        kernels::Prefetch(levels_.level[0].planes[p] + FirstOf(place) + i);
      }
    }
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
      ids.next = WriteIds(bits,
                          levels_.ids + size_t{place & detail::kBlockMask} *
                                            detail::kBlockObjects,
                          ids.next);
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
      if (!Take(unsure[u].place, FloatBits(unsure[u].place, unsure[u].bits))) {
        return false;
      }
    }
    return true;
  }

  // Of `bits`. One object after another, or, from so many on, the block at
  // once: the same time.
  uint64_t FloatBits(uint32_t place, uint64_t bits) const {
    constexpr size_t kFew = 6;
    const WalkQuery& query = queries_[QueryOf(place)];
    const size_t first = FirstOf(place);
    if (const detail::WalkShape* const shape = walk_.shape;
        shape != nullptr && shape->touching != nullptr) {
      bits = shape->touching(*shape, levels_.level[0], first, bits);
      if (bits == 0 || shape->instead != nullptr) return bits;
    }
    if (hwy::PopCount(bits) > kFew) {
      return bits &
             BlockFloatBits(std::make_index_sequence<kPlanes>(), first, query);
    }
    uint64_t kept = 0;
    for (; bits != 0; bits &= bits - 1) {
      const size_t bit = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      kept |= uint64_t{!FloatsReject(first + bit, query)} << bit;
    }
    return kept;
  }

  bool FloatsReject(size_t i, const WalkQuery& query) const {
    const auto& planes = levels_.level[0].planes;
    bool rejects = false;
    for (size_t k = 0; k < kAxes; ++k) {
      rejects |= planes[k][i] > query.lanes[k];
      if constexpr (kHasMax) {
        rejects |= -planes[kAxes + k][i] >
                   query.lanes[detail::BlockScale::kMaxLane + k];
      }
    }
    return rejects;
  }

  template <size_t... kPlane>
  uint64_t BlockFloatBits(std::index_sequence<kPlane...>, size_t first,
                          const WalkQuery& query) const {
    const OneTag<float> d;
    const float* planes[] = {levels_.level[0].planes[kPlane]...};
    return KeptBits<kAxes>(
        d, LoadAll(), planes, first,
        hn::Set(d, kPlane < kAxes ? query.lanes[LaneOf<kAxes>(kPlane)]
                                  : -query.lanes[LaneOf<kAxes>(kPlane)])...);
  }

  const detail::Walk& walk_;
  const detail::BvhLevels& levels_;
  const bool has_masks_;
  size_t first_query_ = 0;
  size_t query_ = 0;  // after the first, whose ids are written
  WalkQuery queries_[detail::kWalkers];
  uint32_t lists_[detail::kMostLevels - 1]
                 [(kChunk + 1) * detail::kBlockObjects];
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
