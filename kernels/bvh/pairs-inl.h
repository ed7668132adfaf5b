// All pairs that overlap: the objects of a block are bounded, 64 such bounds
// walk as queries to the blocks that they meet, and of two blocks only those
// objects are compared that meet the other block's bound.
#if defined(HALFSPACE_KERNELS_BVH_PAIRS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_PAIRS_INL_H_
#undef HALFSPACE_KERNELS_BVH_PAIRS_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_PAIRS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/bvh/block.h"
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/walk-inl.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HALFSPACE_MASKED_COMPARES
// Writes the pairs of the lanes of two vectors. Highway's takes six shuffles.
HWY_INLINE void StorePairs(__m512i a, __m512i b, uint32_t* to) {
  const __m512i low =
      _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
  _mm512_storeu_si512(to, _mm512_permutex2var_epi32(a, low, b));
  _mm512_storeu_si512(to + 16, _mm512_permutex2var_epi32(a, high, b));
}
#endif

template <size_t kAxes>
class PairWalker
    : public Walker<PlaneQueries<kAxes, true>, true, PairWalker<kAxes>> {
  using Base = Walker<PlaneQueries<kAxes, true>, true, PairWalker<kAxes>>;
  friend Base;
  static constexpr size_t kPlanes = 2 * kAxes;
  static constexpr std::make_index_sequence<kPlanes> kEachPlane{};
  using Tag = hn::CappedTag<float, 16>;
  using IdTag = hn::Rebind<uint32_t, Tag>;

 public:
  explicit PairWalker(const detail::PairJoin& join)
      : Base(join.walk), join_(join) {
    this->query_ = PlaneQueries<kAxes, true>(bounds_);
  }

  void Run() {
    for (size_t block = join_.begin; block < join_.end;) {
      size_t count = 0;
      for (; block < join_.end && count < detail::kWalkers; ++block) {
        uint64_t members = Objects(*join_.queries, block);
        if (join_.set != nullptr) members &= join_.set[block];
        if (members == 0) continue;
        block_[count] = static_cast<uint32_t>(block);
        members_[count] = members;
        BoundMembers(block, members, bounds_[count]);
        ++count;
      }
      for (size_t q = 0; q < count; ++q) {
        if (!this->WalkNodes(q)) return;
      }
      if (!this->VisitList()) return;
    }
  }

 private:
  // The objects of a block that exist and have one of the masks.
  uint64_t Objects(const detail::BvhLevels& levels, size_t block) const {
    const detail::BvhLevel& level = levels.level[0];
    uint64_t objects = level.present[block];
    if (level.masks != nullptr && ~this->walk_.mask != 0) {
      objects &= MaskBits(level.masks + block * detail::kBlockObjects,
                          this->walk_.mask);
    }
    return objects;
  }

  // The bound of some objects of a block. A NaN is infinite, which rejects no
  // more.
  void BoundMembers(size_t block, uint64_t members, float* bound) const {
    const Tag d;
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (size_t p = 0; p < kPlanes; ++p) {
      auto least = hn::Set(d, kInf);
      for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
        const uint64_t some = members >> i;
        const auto is_member =
            hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&some));
        auto v = hn::LoadU(d, join_.queries->level[0].Plane(block, p) + i);
        if (p >= kAxes) v = hn::Neg(v);
        v = hn::IfThenElse(hn::Eq(v, v), v, hn::Set(d, -kInf));
        least = hn::Min(least, hn::IfThenElse(is_member, v, hn::Set(d, kInf)));
      }
      const float value = LeastLane(d, least);
      bound[p] = p < kAxes ? value : -value;
    }
  }

  // The nodes whose blocks follow the query's: each pair of blocks is found
  // from the first of both.
  HWY_INLINE uint64_t WantedNodes(size_t query, size_t level,
                                  size_t block) const {
    if (!join_.is_one_world || join_.set != nullptr) return ~uint64_t{0};
    const size_t first = block_[query] >> (6 * (level - 1));
    const size_t begin = block * detail::kBlockObjects;
    if (first <= begin) return ~uint64_t{0};
    const size_t before = first - begin;
    return before < detail::kBlockObjects ? ~uint64_t{0} << before : 0;
  }

  bool VisitLeaves(const uint32_t* places, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      if (!Join(this->QueryOf(places[i]), this->BlockOf(places[i]))) {
        return false;
      }
    }
    return true;
  }

  // The pairs of a query's members and the objects of a block.
  bool Join(size_t query, size_t block) {
    const detail::BvhLevels& levels = this->levels_;
    const detail::BvhLevels& queries = *join_.queries;
    const size_t own = block_[query];
    uint64_t members = members_[query];
    uint64_t objects = Objects(levels, block);
    if (join_.is_one_world && block == own) {
      const size_t count = Gather(queries, own, members, 0);
      return Compare<true, false>(
          queries, own, members,
          Gather(levels, own, objects & ~members, count));
    }
    // Found from both blocks.
    if (join_.set != nullptr && block < own) objects &= ~join_.set[block];
    objects &= TestFloats<kAxes, true>(levels.level[0], block, bounds_[query]);
    if (objects == 0) return true;
    if ((members & (members - 1)) == 0) {
      // The bound is its own, so these are its pairs.
      return WriteAll(queries.ids[own * detail::kBlockObjects +
                                  hwy::Num0BitsBelowLS1Bit_Nonzero64(members)],
                      objects, levels.ids + block * detail::kBlockObjects);
    }
    if (levels.count > 1) {
      float node[kPlanes];
      for (size_t p = 0; p < kPlanes; ++p) {
        node[p] = levels.level[1].Value(p, block);
      }
      members &= TestFloats<kAxes, true>(queries.level[0], own, node);
      if (members == 0) return true;
    }
    if (hwy::PopCount(members) <= hwy::PopCount(objects)) {
      return Compare<false, false>(queries, own, members,
                                   Gather(levels, block, objects, 0));
    }
    return Compare<false, true>(levels, block, objects,
                                Gather(queries, own, members, 0));
  }

  // Appends some objects of a block to those that are compared; returns how
  // many there are then.
  size_t Gather(const detail::BvhLevels& levels, size_t block, uint64_t objects,
                size_t count) {
    for (; objects != 0; objects &= objects - 1, ++count) {
      const size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero64(objects);
      for (size_t p = 0; p < kPlanes; ++p) {
        values_[p][count] = levels.level[0].Plane(block, p)[i];
      }
      ids_[count] = levels.ids[block * detail::kBlockObjects + i];
    }
    return count;
  }

  static uint64_t LowBits(size_t count) { return ~uint64_t{0} >> (64 - count); }

  // Each of some objects of a block with the gathered ones: with kIsOwn they
  // are the first of these, and are compared with those after them.
  template <bool kIsOwn, bool kIsSecond>
  bool Compare(const detail::BvhLevels& levels, size_t block, uint64_t objects,
               size_t count) {
    const size_t lanes = hn::Lanes(Tag());
    uint64_t wanted = LowBits(count);
    size_t begin = 0;
    for (; objects != 0; objects &= objects - 1) {
      if (!HasRoom()) return false;
      if constexpr (kIsOwn) {
        wanted &= wanted - 1;
        if (wanted == 0) break;
        begin = hwy::Num0BitsBelowLS1Bit_Nonzero64(wanted) / lanes * lanes;
      }
      const size_t i = block * detail::kBlockObjects +
                       hwy::Num0BitsBelowLS1Bit_Nonzero64(objects);
      join_.pairs->next = CompareOne<kIsSecond>(
          kEachPlane, levels, i, begin, count, wanted, join_.pairs->next);
    }
    return true;
  }

  HWY_INLINE bool HasRoom() const {
    detail::PairSink& pairs = *join_.pairs;
    return static_cast<size_t>(pairs.end - pairs.next) >=
               2 * detail::kBlockObjects ||
           pairs.make_room(pairs);
  }

  // Object i with those of the gathered ones from `begin` on that are wanted.
  template <bool kIsSecond, size_t... kPlane>
  HWY_INLINE uint32_t* CompareOne(std::index_sequence<kPlane...>,
                                  const detail::BvhLevels& levels, size_t i,
                                  size_t begin, size_t count, uint64_t wanted,
                                  uint32_t* to) const {
    const Tag d;
    const detail::BvhLevel& level = levels.level[0];
    return CompareWith<kIsSecond>(
        kEachPlane, levels.ids[i], begin, count, wanted, to,
        hn::Set(d, level.Value((kPlane + kAxes) % kPlanes, i))...);
  }

  // The values are arguments, as they would be loaded again after each store.
  template <bool kIsSecond, size_t... kPlane, class... V>
  HWY_INLINE uint32_t* CompareWith(std::index_sequence<kPlane...>, uint32_t id,
                                   size_t begin, size_t count, uint64_t wanted,
                                   uint32_t* to, V... opposing) const {
    const Tag d;
    const size_t lanes = hn::Lanes(d);
    const float* const values[] = {values_[kPlane]...};
    uint64_t kept = 0;
    for (size_t j = begin; j < count; j += lanes) {
      uint64_t bits =
          VerdictBits(d, Verdict<kAxes>(d, LoadAll(), values, j, opposing...));
      if constexpr (!kVerdictIsKept<Tag>) bits ^= LowBits(lanes);
      bits &= wanted >> j;
      if constexpr (HALFSPACE_MASKED_COMPARES != 0) {
        to = WritePairs<kIsSecond>(id, bits, ids_ + j, to);
      } else {
        kept |= bits << j;
      }
    }
    if constexpr (HALFSPACE_MASKED_COMPARES == 0) {
      to = WritePairs<kIsSecond>(id, kept, ids_, to);
    }
    return to;
  }

  // Writes the pairs of an id and those of some objects of a block.
  bool WriteAll(uint32_t id, uint64_t objects, const uint32_t* ids) const {
    if (!HasRoom()) return false;
    uint32_t*& to = join_.pairs->next;
    if constexpr (HALFSPACE_MASKED_COMPARES != 0) {
      for (; objects != 0; objects >>= 16, ids += 16) {
        to = WritePairs<false>(id, objects & 0xFFFF, ids, to);
      }
    } else {
      to = WritePairs<false>(id, objects, ids, to);
    }
    return true;
  }

  // Writes pairs of an id and those of some gathered objects, of a vector where
  // it has masks.
  template <bool kIsSecond>
  static HWY_INLINE uint32_t* WritePairs(uint32_t id, uint64_t objects,
                                         const uint32_t* ids, uint32_t* to) {
#if HALFSPACE_MASKED_COMPARES
    // Also of few: a branch would not be predicted.
    const __m512i one = _mm512_set1_epi32(static_cast<int32_t>(id));
    const __m512i others = _mm512_maskz_compress_epi32(
        static_cast<__mmask16>(objects), _mm512_loadu_si512(ids));
    StorePairs(kIsSecond ? others : one, kIsSecond ? one : others, to);
#else
    ForFewBits(objects, [&](size_t n, size_t bit) HWY_ATTR {
      to[2 * n] = kIsSecond ? ids[bit] : id;
      to[2 * n + 1] = kIsSecond ? id : ids[bit];
    });
#endif
    return to + 2 * hwy::PopCount(objects);
  }

  // A vector of the gathered ones may end beyond the last.
  static constexpr size_t kRoom = detail::kBlockObjects + hn::MaxLanes(Tag());

  const detail::PairJoin& join_;
  uint32_t block_[detail::kWalkers];
  uint64_t members_[detail::kWalkers];
  float bounds_[detail::kWalkers][kPlanes];
  HWY_ALIGN float values_[kPlanes][kRoom] = {};
  HWY_ALIGN uint32_t ids_[kRoom] = {};
};

template <size_t kAxes>
void JoinPairs(const detail::PairJoin& join) {
  PairWalker<kAxes>(join).Run();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_PAIRS_INL_H_
