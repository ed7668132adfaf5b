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

#include "hwy/highway.h"
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/curve-inl.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/compiler.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Calls write(i, bit) for the i-th set bit. The first four calls are made
// without a branch, so elements 0 ... 3 are written even if fewer bits are set.
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

// Writes ids[i] for every set bit i; all are below `count`. `to` must have room
// for 64 ids.
HWY_INLINE uint32_t* WriteIds(uint64_t bits, const uint32_t* ids, size_t count,
                              uint32_t* to) {
#if HALFSPACE_MASKED_COMPARES
  const hn::CappedTag<uint32_t, 16> d;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto some = static_cast<uint16_t>(bits >> i);
    hn::StoreU(hn::Compress(hn::LoadU(d, ids + i), hn::Mask<decltype(d)>{some}),
               d, to);
    to += hwy::PopCount(uint64_t{some});
  }
  return to;
#else
  (void)count;
  ForFewBits(bits, [&](size_t i, size_t bit) HWY_ATTR { to[i] = ids[bit]; });
  return to + hwy::PopCount(bits);
#endif
}

// Queries that are bounds. Each plane of an object or node is compared with the
// opposing plane of the query.
template <size_t kAxes, bool kHasMax>
class PlaneQueries {
 public:
  static constexpr size_t kPlanes = kBlockPlanes<kAxes, kHasMax>;
  static constexpr bool kHasCodes = true;
  static constexpr bool kFindsInside = kHasMax;

  explicit PlaneQueries(const void* queries)
      : queries_(static_cast<const float*>(queries)) {}

  HWY_INLINE uint64_t Test(size_t query, const detail::BvhLevel& level,
                           size_t block) const {
    return TestFloats<kAxes, kHasMax>(level, block, At(query));
  }
  HWY_NOINLINE uint64_t TestApart(size_t query, const detail::BvhLevel& level,
                                  size_t block) const {
    return Test(query, level, block);
  }
  HWY_INLINE uint64_t TestOnlyLeaf(size_t query,
                                   const detail::BvhLevel& level) const {
    return TestFloats<kAxes, kHasMax, true>(level, 0, At(query));
  }
  template <typename Function>
  static bool Outside(const Function& function) {
    return function();
  }
  // The nodes of `kept` all of whose objects survive.
  HWY_INLINE uint64_t Inside(size_t query, const detail::BvhLevel& level,
                             size_t block, uint64_t kept) const {
    return kept & InsideBits<kAxes>(level, block, At(query));
  }

  // Encodes a query, to test objects by their codes.
  HWY_INLINE void Encode(size_t query, const detail::CodeMap& map,
                         QueryCodes& codes) const {
    EncodeQuery<kAxes, kHasMax>(map, At(query), codes);
  }
  static HWY_INLINE LeafBits Test(const QueryCodes& query,
                                  const int16_t* codes) {
    return TestCodes<kAxes, kPlanes>(codes, query);
  }
  bool Rejects(size_t query, const detail::BvhLevel& level, size_t block,
               size_t lane) const {
    const float* const values = At(query);
    bool rejects = false;
    for (size_t p = 0; p < kPlanes; ++p) {
      const float own = level.Plane(block, p)[lane];
      const float opposing = values[OpposingPlane<kAxes, kPlanes>(p)];
      rejects |= p < kAxes ? own > opposing : own < opposing;
    }
    return rejects;
  }

  const float* At(size_t query) const { return queries_ + query * kPlanes; }

 private:
  const float* queries_;
};

// If at least so many nodes of a block survive, the walk looks for nodes inside
// the query. A query that is not larger than a node has none inside.
inline constexpr size_t kManyKept = 8;

// Walks from the root to the objects that survive, in two steps. Nodes are
// tested depth first, and leaves that survive are put on a list, so that all of
// them are prefetched before the first is read. The list has the leaves of
// several queries. Query is PlaneQueries or a shape (shapes-inl.h). Leaves, if
// given, is a class that derives from this one. It has VisitLeaves(), which
// reads the leaves of a list, and NodesToVisit().
template <class Query, bool kWrites, class Leaves = void>
class Walker {
 public:
  explicit Walker(const detail::Walk& walk)
      : walk_(walk),
        levels_(*walk.levels),
        query_(walk.queries),
        has_masks_(levels_.level[0].masks != nullptr && ~walk.mask != 0),
        top_(TopLevel(levels_)),
        many_leaves_(walk.is_urgent ? 1 : kManyLeaves) {}

  void Run() {
    for (size_t q = 0; q < walk_.query_count; ++q) {
      if (!WalkNodes(q)) break;
      const bool is_last = q + 1 == walk_.query_count;
      if (q + 1 - first_query_ < detail::kWalkers && !is_last) continue;
      if (!VisitList()) break;
      EndQueries(q + 1);
      first_query_ = q + 1;
    }
    if (walk_.statistics != nullptr) {
      walk_.statistics->node_blocks += node_blocks_;
      walk_.statistics->leaves += leaves_;
    }
  }

 protected:
  static constexpr bool kHasLeaves = !std::is_void_v<Leaves>;
  // When the list has at least so many leaves, they are read. The leaves of one
  // block of nodes are added together, so the list can be longer by 64. With 64
  // instead of 16, prefetched lines evict each other, and a query of a million
  // boxes takes 1.1 times as long.
  static constexpr size_t kManyLeaves = 16;

  // An entry of the list has a block, whether it is inside the query, and the
  // number of the query among those that walk together.
  static size_t BlockOf(uint32_t place) { return place & detail::kBlockMask; }
  static bool IsInside(uint32_t place) {
    return (place & detail::kInsideBit) != 0;
  }
  size_t QueryOf(uint32_t place) const {
    return first_query_ + (place >> detail::kQueryShift);
  }

  // Walks from the root to the leaves that the query may touch, and lists them.
  // Returns false if the output wants no more.
  HWY_INLINE bool WalkNodes(size_t query) {
    struct Children {
      uint64_t kept;  // still to visit
      uint64_t inside;
      size_t first;
    };
    Children children[detail::kMostLevels];
    size_t level = top_;
    size_t block = 0;
    bool is_inside = false;
    if (level == 0) return VisitOnlyLeaf(query);
    for (;;) {
      const detail::BvhLevel& nodes = levels_.level[level];
      Children& own = children[level];
      own.first = block * detail::kBlockObjects;
      ++node_blocks_;
      if (is_inside) {
        own.inside = own.kept = nodes.present[block];
      } else {
        own.kept =
            Filter(query, level, block, query_.Test(query, nodes, block));
        own.inside = Inside(query, level, block, own.kept);
        if constexpr (!kWrites) {
          if (own.inside != 0) Count(query, level, block, own.inside);
          own.kept &= ~own.inside;
        }
      }
      if (level == 1) {
        while (own.kept != 0) {
          uint64_t some = own.kept;
          // One leaf at a time until a survivor is found.
          if (kWrites && !kHasLeaves && many_leaves_ == 1) some &= ~some + 1;
          own.kept ^= some;
          if (!ListLeaves(query, own.first, some, own.inside & some)) {
            return false;
          }
        }
      }
      while (children[level].kept == 0) {
        if (++level > top_) return true;
      }
      Children& next = children[level];
      const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(next.kept);
      next.kept &= next.kept - 1;
      is_inside = (next.inside >> lane & 1) != 0;
      block = next.first + lane;
      --level;
    }
  }

  // The walk of a world without nodes.
  HWY_INLINE bool VisitOnlyLeaf(size_t query) {
    if constexpr (kHasLeaves) return ListLeaves(query, 0, 1, 0);
    EndQueries(query);
    ++leaves_;
    const uint64_t kept =
        Filter(query, 0, 0, query_.TestOnlyLeaf(query, levels_.level[0]));
    return kept == 0 || Take(query, 0, kept);
  }

  HWY_INLINE bool ListLeaves(size_t query, size_t first, uint64_t kept,
                             uint64_t inside) {
    const auto place = static_cast<uint32_t>(
        (query - first_query_) << detail::kQueryShift | first);
    uint32_t* const to = list_ + list_size_;
    ForFewBits(kept, [&](size_t n, size_t bit) HWY_ATTR {
      to[n] = place + static_cast<uint32_t>(bit);
    });
    const size_t leaves = hwy::PopCount(kept);
    if (kWrites && inside != 0) {
      for (size_t n = 0; n < leaves; ++n) {
        const uint64_t bit = inside >> (to[n] % detail::kBlockObjects) & 1;
        to[n] |= static_cast<uint32_t>(bit) * detail::kInsideBit;
      }
    }
    if (levels_.level[0].is_prefetched && many_leaves_ > 1) {
      for (size_t n = 0; n < leaves; ++n) PrefetchLeaf(to[n]);
    }
    list_size_ += leaves;
    return list_size_ < many_leaves_ || VisitList();
  }

  // Reads the leaves on the list.
  HWY_NOINLINE bool VisitList() {
    const size_t size = list_size_;
    if (size == 0) return true;
    list_size_ = 0;
    if constexpr (kHasLeaves) {
      return static_cast<Leaves*>(this)->VisitLeaves(list_, size);
    } else {
      if constexpr (Query::kHasCodes) {
        if (levels_.codes != nullptr) return VisitCodes(size);
      }
      return VisitFloats(size);
    }
  }

  // The bits of `kept` whose objects or nodes also have one of the wanted
  // masks, and which the leaves' class wants to visit.
  HWY_INLINE uint64_t Filter(size_t query, size_t level, size_t block,
                             uint64_t kept) {
    if constexpr (kHasLeaves) {
      kept &= static_cast<Leaves*>(this)->NodesToVisit(query, level, block);
    }
    if (kept != 0 && has_masks_) {
      kept &=
          MaskBits(levels_.level[level].masks + block * detail::kBlockObjects,
                   walk_.mask);
    }
    return kept;
  }

  // The nodes of `kept` all of whose objects survive.
  HWY_INLINE uint64_t Inside(size_t query, size_t level, size_t block,
                             uint64_t kept) {
    if constexpr (Query::kFindsInside && !kHasLeaves) {
      if (has_masks_ || levels_.level[level].regular == nullptr) return 0;
      if (kWrites && hwy::PopCount(kept) < kManyKept) return 0;
      const detail::BvhLevel& nodes = levels_.level[level];
      kept &= nodes.regular[block];
      return kept == 0 ? 0 : query_.Inside(query, nodes, block, kept);
    }
    return 0;
  }

  // Adds the objects of the nodes inside the query, without a visit.
  void Count(size_t query, size_t level, size_t block, uint64_t inside) {
    const detail::BvhLevel& nodes = levels_.level[level];
    const size_t objects_of_node = size_t{1} << (6 * level);
    size_t objects = hwy::PopCount(inside) * objects_of_node;
    // The last node may have fewer objects.
    const size_t last = nodes.size - 1;
    if (last / detail::kBlockObjects == block &&
        (inside >> (last % detail::kBlockObjects) & 1) != 0) {
      objects -= nodes.size * objects_of_node - levels_.level[0].size;
    }
    walk_.counts[query] += objects;
  }

  template <size_t kCount, typename T>
  static HWY_INLINE void PrefetchAll(const T* values) {
    for (size_t i = 0; i < kCount; i += 64 / sizeof(T)) {
      kernels::Prefetch(values + i);
    }
  }

  void PrefetchLeaf(uint32_t place) const {
    if constexpr (kHasLeaves) {
      if (!static_cast<const Leaves*>(this)->ReadsCodes(QueryOf(place))) return;
    }
    if (IsInside(place)) return;
    if constexpr (Query::kHasCodes) {
      // A tree without codes is small.
      if (levels_.codes == nullptr) return;
      PrefetchAll<Query::kPlanes * detail::kBlockObjects>(CodesOf(place));
    } else {
      const detail::BvhLevel& objects = levels_.level[0];
      for (size_t p = 0; p < objects.planes; ++p) {
        PrefetchAll<detail::kBlockObjects>(objects.Plane(BlockOf(place), p));
      }
    }
  }

  const int16_t* CodesOf(uint32_t place) const {
    return levels_.codes +
           BlockOf(place) * detail::kBlockObjects * Query::kPlanes;
  }

  // Tests the leaves of the list by their codes. Objects whose codes decide
  // nothing are tested by their floats, after the codes of all leaves.
  HWY_NOINLINE bool VisitCodes(size_t size) {
    Unsure unsure[kManyLeaves + detail::kBlockObjects];
    size_t unsure_count = 0;
    size_t encoded = kNone;
    QueryCodes codes;
    for (size_t i = 0; i < size; ++i) {
      const uint32_t place = list_[i];
      const size_t block = BlockOf(place);
      const size_t query = QueryOf(place);
      ++leaves_;
      if (query != encoded) {
        if (unsure_count != 0 && !Resolve(encoded, unsure, unsure_count)) {
          return false;
        }
        unsure_count = 0;
        EndQueries(query);
        encoded = query;
        query_.Encode(query, *levels_.map, codes);
      }
      uint64_t kept = levels_.level[0].present[block];
      if (!IsInside(place)) {
        const LeafBits bits = Query::Test(codes, CodesOf(place));
        kept = Filter(query, 0, block, kept & bits.kept);
        unsure[unsure_count] = {block, bits.unsure & kept};
        unsure_count += (bits.unsure & kept) != 0;
        kept &= ~bits.unsure;
      }
      if (kept != 0 && !Take(query, block, kept)) return false;
      if (many_leaves_ == 1 && unsure_count != 0) {  // nothing found yet
        if (!Resolve(query, unsure, unsure_count)) return false;
        unsure_count = 0;
      }
    }
    return unsure_count == 0 || Resolve(encoded, unsure, unsure_count);
  }

  // Tests the leaves of the list by their floats.
  bool VisitFloats(size_t size) {
    for (size_t i = 0; i < size; ++i) {
      const uint32_t place = list_[i];
      const size_t block = BlockOf(place);
      const size_t query = QueryOf(place);
      ++leaves_;
      EndQueries(query);
      uint64_t kept = levels_.level[0].present[block];
      if (!IsInside(place)) {
        kept = Filter(query, 0, block,
                      query_.TestApart(query, levels_.level[0], block));
      }
      if (kept != 0 && !Take(query, block, kept)) return false;
    }
    return true;
  }

  HWY_INLINE void EndQueries(size_t end) {
    if constexpr (kWrites && !kHasLeaves) {
      detail::WalkIds& ids = *walk_.ids;
      if (ids.offsets == nullptr) return;
      for (; ended_ < end; ++ended_) *++ids.offsets = ids.Total();
    }
  }

  HWY_NOINLINE bool Take(size_t query, size_t block, uint64_t bits) {
    if constexpr (kWrites) {
      detail::WalkIds& ids = *walk_.ids;
      const size_t first = block * detail::kBlockObjects;
      ids.next = WriteIds(
          bits, levels_.ids + first,
          HWY_MIN(levels_.level[0].size - first, detail::kBlockObjects),
          ids.next);
      if (ids.next >= ids.full) [[unlikely]] {
        many_leaves_ = kManyLeaves;
        return query_.Outside([&ids] { return ids.flush(ids); });
      }
    } else {
      walk_.counts[query] += hwy::PopCount(bits);
    }
    return true;
  }

  struct Unsure {
    size_t block;
    uint64_t bits;
  };

  HWY_NOINLINE bool Resolve(size_t query, const Unsure* unsure, size_t count) {
    for (size_t u = 0; u < count; ++u) {
      const uint64_t kept = KeptOf(query, unsure[u].block, unsure[u].bits);
      if (kept != 0 && !Take(query, unsure[u].block, kept)) return false;
    }
    return true;
  }

  // Tests the floats of the objects of `bits`: one by one, or the whole block
  // at once if they are more than kFew. With kFew objects both take the same
  // time.
  uint64_t KeptOf(size_t query, size_t block, uint64_t bits) const {
    constexpr size_t kFew = 6;
    const detail::BvhLevel& objects = levels_.level[0];
    if (hwy::PopCount(bits) > kFew) {
      return bits & query_.TestApart(query, objects, block);
    }
    uint64_t kept = 0;
    for (; bits != 0; bits &= bits - 1) {
      const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      kept |= uint64_t{!query_.Rejects(query, objects, block, lane)} << lane;
    }
    return kept;
  }

  static constexpr size_t kNone = ~size_t{0};

  const detail::Walk& walk_;
  const detail::BvhLevels& levels_;
  Query query_;
  const bool has_masks_;
  const size_t top_;
  size_t many_leaves_;
  size_t list_size_ = 0;
  size_t first_query_ = 0;  // of those that walk together
  size_t ended_ = 0;        // queries whose ids are written
  size_t node_blocks_ = 0;
  size_t leaves_ = 0;
  uint32_t list_[kManyLeaves + detail::kBlockObjects];
};

// The walk of one box or octahedron in a small tree that is in cache: one leaf,
// leaves without codes under one block of nodes, or leaves with codes under two
// levels of nodes. Its loops have nothing of what a Walker needs for masks,
// lists of leaves and several queries.
template <size_t kAxes, bool kWrites>
class PlainWalk {
 public:
  explicit PlainWalk(const detail::Walk& walk)
      : walk_(walk), levels_(*walk.levels), query_(walk.queries) {}

  // Returns false, and does nothing, if a Walker is needed or takes less time.
  HWY_INLINE bool Run() {
    const detail::BvhLevel& objects = levels_.level[0];
    const bool has_masks = objects.masks != nullptr && ~walk_.mask != 0;
    if (walk_.query_count != 1 || walk_.statistics != nullptr || has_masks) {
      return false;
    }
    if constexpr (kWrites) {
      const detail::WalkIds& ids = *walk_.ids;
      if (ids.offsets != nullptr) return false;
    }
    if (objects.size <= detail::kBlockObjects) {
      const uint64_t kept = query_.TestOnlyLeaf(0, objects);
      if (kept != 0) Take(0, objects.size, kept);
      return true;
    }
    const bool has_codes = levels_.codes != nullptr;
    const size_t top = has_codes ? 2 : 1;
    const detail::BvhLevel& root = levels_.level[top];
    if (root.size > detail::kBlockObjects) return false;
    // After erasures, the root of a tree with codes can be on level 1.
    if (has_codes &&
        (objects.size <= detail::kMostWithoutCodes || objects.is_prefetched)) {
      return false;
    }
    const uint64_t kept = query_.TestApart(0, root, 0);
    // Only a Walker uses nodes that are inside the query.
    if (hwy::PopCount(kept) >= kManyKept) return false;
    has_codes ? VisitNodes(kept) : VisitFloats(kept);
    return true;
  }

 private:
  static constexpr size_t kPlanes = kBlockPlanes<kAxes, true>;

  // Visits leaves under the root.
  HWY_INLINE void VisitFloats(uint64_t leaves) {
    const detail::BvhLevel& objects = levels_.level[0];
    for (; leaves != 0; leaves &= leaves - 1) {
      const size_t block = hwy::Num0BitsBelowLS1Bit_Nonzero64(leaves);
      const uint64_t kept =
          objects.present[block] &
          TestBlock<kAxes, kPlanes, false>(objects, block, 0,
                                           detail::kBlockObjects, query_.At(0));
      if (!Take(block, detail::kBlockObjects, kept)) return;
    }
  }

  // Visits nodes under the root, and their leaves.
  HWY_INLINE void VisitNodes(uint64_t nodes_kept) {
    const detail::BvhLevel& nodes = levels_.level[1];
    QueryCodes codes;
    query_.Encode(0, *levels_.map, codes);
    for (; nodes_kept != 0; nodes_kept &= nodes_kept - 1) {
      const size_t node = hwy::Num0BitsBelowLS1Bit_Nonzero64(nodes_kept);
      uint64_t leaves = query_.TestApart(0, nodes, node);
      const uint64_t inside =
          hwy::PopCount(leaves) >= kManyKept ? Inside(nodes, node, leaves) : 0;
      for (; leaves != 0; leaves &= leaves - 1) {
        const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(leaves);
        const size_t block = node * detail::kBlockObjects + lane;
        const uint64_t kept = (inside >> lane & 1) != 0
                                  ? levels_.level[0].present[block]
                                  : TestLeaf(block, codes);
        if (!Take(block, detail::kBlockObjects, kept)) return;
      }
    }
  }

  HWY_NOINLINE uint64_t Inside(const detail::BvhLevel& nodes, size_t block,
                               uint64_t kept) const {
    const uint64_t regular = kept & nodes.regular[block];
    return regular == 0 ? 0 : query_.Inside(0, nodes, block, regular);
  }

  HWY_INLINE uint64_t TestLeaf(size_t block, const QueryCodes& codes) const {
    const LeafBits bits = TestCodes<kAxes, kPlanes>(
        levels_.codes + block * kPlanes * detail::kBlockObjects, codes);
    const uint64_t kept = bits.kept & levels_.level[0].present[block];
    const uint64_t unsure = bits.unsure & kept;
    if (unsure == 0) [[likely]] {
      return kept;
    }
    // This is rare, so it tests the whole block, which is less code than to
    // test object after object.
    return (kept & ~unsure) |
           (unsure & query_.TestApart(0, levels_.level[0], block));
  }

  HWY_INLINE bool Take(size_t block, size_t count, uint64_t kept) {
    if constexpr (kWrites) {
      detail::WalkIds& ids = *walk_.ids;
      ids.next = WriteIds(kept, levels_.ids + block * detail::kBlockObjects,
                          count, ids.next);
      return ids.next < ids.full || ids.flush(ids);
    } else {
      *walk_.counts += hwy::PopCount(kept);
      return true;
    }
  }

  const detail::Walk& walk_;
  const detail::BvhLevels& levels_;
  const PlaneQueries<kAxes, true> query_;
};

template <class Query, bool kWrites>
void RunWalk(const detail::Walk& walk) {
  Walker<Query, kWrites>(walk).Run();
}

// Simplices use only the Walker, because few of their queries would gain. Plain
// code gains nothing, but finds the objects in the order of other targets.
template <size_t kAxes, bool kHasMax, bool kWrites>
void RunPlaneWalk(const detail::Walk& walk) {
  if constexpr (kHasMax) {
    if (PlainWalk<kAxes, kWrites>(walk).Run()) return;
  }
  RunWalk<PlaneQueries<kAxes, kHasMax>, kWrites>(walk);
}

template <size_t kAxes, bool kHasMax>
constexpr detail::BvhKernels::OfPlanes MakeBvhKernelsOf() {
  return {&FindCenters<kAxes, kHasMax>,
          &FindPlaces<kAxesOfCenters<kAxes, kHasMax>>,
          &EncodeBlocks<kAxes, kHasMax>,
          &NearestNode<kAxes, kHasMax>,
          &RunPlaneWalk<kAxes, kHasMax, true>,
          &RunPlaneWalk<kAxes, kHasMax, false>};
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
