// Finds all pairs that overlap. The objects of a block get one bound. 64 such
// bounds walk together as queries to the blocks that they overlap. For two such
// blocks, only the objects that overlap the bound of the other block are
// compared.
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
#include "kernels/bvh/blocks-inl.h"
#include "kernels/bvh/half_space_sum-inl.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/bvh/walk-inl.h"
#include "kernels/fp_mode.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HALFSPACE_MASKED_COMPARES
// Writes a pair for each lane of two vectors. Highway's function takes six
// shuffles.
HWY_INLINE void StorePairs(__m512i a, __m512i b, uint32_t* to) {
  const __m512i low =
      _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i high = _mm512_add_epi32(low, _mm512_set1_epi32(8));
  _mm512_storeu_si512(to, _mm512_permutex2var_epi32(a, low, b));
  _mm512_storeu_si512(to + 16, _mm512_permutex2var_epi32(a, high, b));
}
#endif

// The queries of this walk are objects too: a query is some objects of one
// block, its members, and `own` is their block. It walks with the bound around
// them. A leaf that it reaches is joined with them, member by member. With
// masks, `wanted_` has the masks that the other object of a pair must have one
// bit of.
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
      : Base(join.walk),
        join_(join),
        is_plain_(join.set != nullptr && !HasWanted() && join.is_one_world &&
                  !join.has_margin && this->top_ <= 1 &&
                  this->levels_.codes == nullptr) {
    this->query_ = PlaneQueries<kAxes, true>(bounds_);
  }

  void Run() {
    const detail::SlotSet* const set = join_.set;
    if (set == nullptr) {
      for (size_t block = join_.begin; block < join_.end; ++block) {
        if (!AddMembers(block, ~uint64_t{0})) return;
      }
    } else {
      for (size_t i = 0; i < set->size; i += 64) {
        for (uint64_t used = UsedEntries(i); used != 0; used &= used - 1) {
          const detail::SlotSet::Block& entry =
              set->blocks[i + hwy::Num0BitsBelowLS1Bit_Nonzero64(used)];
          if (entry.block < join_.begin || entry.block >= join_.end) continue;
          if (!AddMembers(entry.block, entry.slots)) return;
        }
      }
    }
    Walk();
  }

 private:
  // Up to so many objects of a block walk one by one, or are joined by
  // JoinEach(). Their common bound would touch more leaves, and take longer for
  // each.
  static constexpr size_t kFewMembers = 8;
  static constexpr size_t kFewPlainMembers = 32;

  bool HasWanted() const {
    return join_.set != nullptr && join_.set->wanted != nullptr;
  }
  // The masks that a member wants, if it walks by itself.
  uint32_t WantedOf(size_t slot) const {
    return HasWanted() ? join_.set->wanted[join_.set->RankOf(slot)]
                       : ~uint32_t{0};
  }
  static bool IsOne(uint64_t members) { return (members & (members - 1)) == 0; }
  static size_t SlotOf(size_t block, uint64_t members) {
    return block * detail::kBlockObjects +
           hwy::Num0BitsBelowLS1Bit_Nonzero64(members);
  }

  // A bit for each of up to 64 entries of the set that is used. A branch would
  // be mispredicted.
  HWY_NOINLINE uint64_t UsedEntries(size_t first) const {
    const size_t count = HWY_MIN(join_.set->size - first, size_t{64});
    uint64_t used = 0;
    for (size_t i = 0; i < count; ++i) {
      used |= uint64_t{join_.set->blocks[first + i].slots != 0} << i;
    }
    return used;
  }

  HWY_NOINLINE bool AddMembers(size_t block, uint64_t members) {
    members &= Objects(*join_.queries, block);
    const size_t few = is_plain_ ? kFewPlainMembers : kFewMembers;
    if (hwy::PopCount(members) > few && !HasWanted()) {
      return AddQuery(block, members);
    }
    if (is_plain_) return JoinEach(block, members);
    for (; members != 0; members &= members - 1) {
      if (!AddQuery(block, members & (~members + 1))) return false;
    }
    return true;
  }

  // Adds a query. When there are kWalkers, they walk.
  HWY_NOINLINE bool AddQuery(size_t block, uint64_t members) {
    block_[count_] = static_cast<uint32_t>(block);
    members_[count_] = members;
    wanted_[count_] = ~uint32_t{0};
    float* const bound = bounds_[count_];
    if (IsOne(members)) {
      const size_t slot = SlotOf(block, members);
      wanted_[count_] = WantedOf(slot);
      for (size_t p = 0; p < kPlanes; ++p) {
        constexpr float kInf = std::numeric_limits<float>::infinity();
        const float value = join_.queries->level[0].Value(p, slot);
        bound[p] = value == value ? value : p < kAxes ? -kInf : kInf;
      }
    } else {
      BoundMembers(block, members, bound);
      ClearRoom();
    }
    if (join_.has_margin) Grow(bound);
    return ++count_ < detail::kWalkers || Walk();
  }

  HWY_NOINLINE bool Walk() {
    const size_t count = count_;
    count_ = 0;
    encoded_ = detail::kWalkers;
    for (size_t q = 0; q < count; ++q) {
      if (!this->WalkNodes(q)) return false;
    }
    return this->VisitList();
  }

  // The objects of a block that exist and have one of the masks.
  uint64_t Objects(const detail::BvhLevels& levels, size_t block) const {
    return levels.level[0].present[block] &
           WithMask(levels.level[0], block, this->walk_.mask);
  }
  // The objects or nodes of a block whose masks have one of the bits of `mask`.
  static uint64_t WithMask(const detail::BvhLevel& level, size_t block,
                           uint32_t mask) {
    if (~mask == 0) return ~uint64_t{0};
    if (level.masks == nullptr) return mask == 0 ? 0 : ~uint64_t{0};
    return MaskBits(level.masks + block * detail::kBlockObjects, mask);
  }

  // The value plus the margin, rounded so that it is not too small in any mode.
  template <class D>
  static HWY_INLINE hn::Vec<D> Above(D d, hn::Vec<D> value, float margin) {
    constexpr float kMost = std::numeric_limits<float>::max();
    constexpr float kLeast = std::numeric_limits<float>::min();
    const auto sum = hn::Add(value, hn::Set(d, margin));
    const auto size = hn::Min(hn::Abs(sum), hn::Set(d, kMost));
    const auto error =
        hn::Add(hn::Mul(size, hn::Set(d, 0x1p-22f)), hn::Set(d, kLeast));
    return hn::Add(sum, error);
  }
  template <class D>
  static HWY_INLINE hn::Vec<D> Outward(D d, size_t plane, hn::Vec<D> value,
                                       const float* margins) {
    return plane < kAxes ? hn::Neg(Above(d, hn::Neg(value), margins[plane]))
                         : Above(d, value, margins[plane - kAxes]);
  }
  HWY_NOINLINE void Grow(float* bound) const {
    const hn::CappedTag<float, 1> d;
    for (size_t p = 0; p < kPlanes; ++p) {
      bound[p] = hn::GetLane(
          Outward(d, p, hn::Set(d, bound[p]), join_.margins.data()));
    }
  }

  // The bound of some objects of a block. A NaN counts as infinite, so it
  // rejects nothing.
  HWY_NOINLINE void BoundMembers(size_t block, uint64_t members,
                                 float* bound) const {
    const Tag d;
    constexpr float kInf = std::numeric_limits<float>::infinity();
    for (size_t p = 0; p < kPlanes; ++p) {
      auto least = hn::Set(d, kInf);
      for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
        const auto is_member = MaskOfBits(d, members >> i);
        auto v = hn::LoadU(d, join_.queries->level[0].Plane(block, p) + i);
        if (p >= kAxes) v = hn::Neg(v);
        v = hn::IfThenElse(hn::Eq(v, v), v, hn::Set(d, -kInf));
        least = hn::Min(least, hn::IfThenElse(is_member, v, hn::Set(d, kInf)));
      }
      const float value = LeastLane(d, least);
      bound[p] = p < kAxes ? value : -value;
    }
  }

  // The nodes that a query has to visit. If all pairs of a world are searched,
  // these are the nodes whose blocks follow the block of the query, because
  // each pair of blocks is found from its first block. If the pairs of a set
  // are searched, these are the nodes with a mask that the query wants.
  HWY_INLINE uint64_t NodesToVisit(size_t query, size_t level,
                                   size_t block) const {
    if (join_.set != nullptr || !join_.is_one_world) {
      return WithMask(this->levels_.level[level], block, wanted_[query]);
    }
    const size_t first = block_[query] >> (6 * (level - 1));
    const size_t begin = block * detail::kBlockObjects;
    if (first <= begin) return ~uint64_t{0};
    const size_t before = first - begin;
    return before < detail::kBlockObjects ? ~uint64_t{0} << before : 0;
  }

  // If a query has several members, their leaves stay in the cache.
  bool ReadsCodes(size_t query) const { return IsOne(members_[query]); }

  HWY_NOINLINE bool VisitLeaves(const uint32_t* places, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      const size_t query = this->QueryOf(places[i]);
      const bool goes_on = IsOne(members_[query])
                               ? JoinOne(query, this->BlockOf(places[i]))
                               : Join(query, this->BlockOf(places[i]));
      if (!goes_on) return false;
    }
    return true;
  }

  // The objects of a block that are queries as well.
  uint64_t MembersOf(size_t block) const {
    return join_.set == nullptr ? ~uint64_t{0} : join_.set->SlotsOf(block);
  }

  uint64_t TestObjects(size_t query, size_t block) const {
    return this->query_.TestApart(query, this->levels_.level[0], block);
  }

  // Finds the pairs of some objects of a block in a small world, one by one.
  // Without lists of queries and leaves this takes 0.6 of the time of walks.
  HWY_NOINLINE bool JoinEach(size_t own, uint64_t members) {
    const detail::BvhLevels& levels = this->levels_;
    const detail::BvhLevel& objects = levels.level[0];
    const uint32_t* const own_ids = levels.ids + own * detail::kBlockObjects;
    const size_t leaves =
        (objects.size + detail::kBlockObjects - 1) / detail::kBlockObjects;
    for (; members != 0; members &= members - 1) {
      const size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero64(members);
      const uint64_t member = uint64_t{1} << i;
      for (size_t p = 0; p < kPlanes; ++p) {
        bounds_[count_][p] = objects.Plane(own, p)[i];
      }
      // The nodes of two leaves take as long as the leaves.
      uint64_t left = leaves <= 2
                          ? LowBits(leaves)
                          : this->query_.TestApart(count_, levels.level[1], 0);
      for (; left != 0; left &= left - 1) {
        const size_t block = hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
        uint64_t kept = Objects(levels, block) & TestObjects(count_, block);
        if (block <= own) {
          const uint64_t before = block < own ? ~uint64_t{0} : member - 1;
          kept &= ~(MembersOf(block) & before);
          if (block == own) kept &= ~member;
        }
        if (!WriteAll(own_ids[i], kept,
                      levels.ids + block * detail::kBlockObjects)) {
          return false;
        }
      }
    }
    return true;
  }

  // Finds the pairs of one object and the objects of a block by their codes.
  HWY_INLINE bool JoinOne(size_t query, size_t block) {
    const detail::BvhLevels& levels = this->levels_;
    const size_t own = block_[query];
    const size_t slot = SlotOf(own, members_[query]);
    uint64_t objects = Objects(levels, block) &
                       WithMask(levels.level[0], block, wanted_[query]);
    if (levels.codes == nullptr) {
      objects &= TestObjects(query, block);
    } else {
      if (encoded_ != query) {
        encoded_ = query;
        this->query_.Encode(query, *levels.map, code_);
      }
      const LeafBits bits = TestCodes<kAxes, kPlanes>(
          levels.codes + block * detail::kBlockObjects * kPlanes, code_);
      objects &= bits.kept;
      const uint64_t unsure = objects & bits.unsure;
      if (unsure != 0) {
        objects = (objects & ~unsure) | this->KeptOf(query, block, unsure);
      }
    }
    if (join_.is_one_world && block <= own && objects != 0) {
      uint64_t before = objects & MembersOf(block);
      if (block == own) {
        objects &= ~members_[query];
        before &= members_[query] - 1;
      }
      objects &= ~(HasWanted() ? FindersOf(slot, block, before) : before);
    }
    if (join_.near.dims != 0 && objects != 0) {
      const float* planes[kPlanes];
      for (size_t p = 0; p < kPlanes; ++p) {
        planes[p] = levels.level[0].Plane(block, p);
      }
      objects = KeepNear(join_.queries->level[0], slot, planes, objects);
    }
    return objects == 0 || WriteAll(join_.queries->ids[slot], objects,
                                    levels.ids + block * detail::kBlockObjects);
  }

  // The members of a block that want an object.
  HWY_NOINLINE uint64_t FindersOf(size_t slot, size_t block,
                                  uint64_t members) const {
    const uint32_t* const masks = this->levels_.level[0].masks;
    const uint32_t mask = masks == nullptr ? ~uint32_t{0} : masks[slot];
    uint64_t finders = 0;
    for (; members != 0; members &= members - 1) {
      const uint32_t wanted = WantedOf(SlotOf(block, members));
      if (~wanted == 0 || (wanted & mask) != 0) {
        finders |= members & (~members + 1);
      }
    }
    return finders;
  }

  // Finds the pairs of the members of a query and the objects of a block.
  HWY_NOINLINE bool Join(size_t query, size_t block) {
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
    // Each of these pairs would be found from both blocks.
    if (join_.is_one_world && block < own) objects &= ~MembersOf(block);
    objects &= TestObjects(query, block);
    if (objects == 0) return true;
    if (levels.count > 1) {
      float node[kPlanes];
      for (size_t p = 0; p < kPlanes; ++p) {
        node[p] = levels.level[1].Value(p, block);
      }
      if (join_.has_margin) Grow(node);
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

  // Clears the memory behind the last gathered object once, because the last
  // vector is read to its end. Objects that walk one by one do not need it.
  void ClearRoom() {
    if (is_room_clear_) return;
    is_room_clear_ = true;
    std::memset(values_, 0, sizeof(values_));
    std::memset(ids_, 0, sizeof(ids_));
  }

  // Appends some objects of a block to the gathered objects, grown by the
  // margin unless their distance is limited. Returns the new number of gathered
  // objects.
  HWY_NOINLINE size_t Gather(const detail::BvhLevels& levels, size_t block,
                             uint64_t objects, size_t count) {
    const size_t begin = count;
    for (; objects != 0; objects &= objects - 1, ++count) {
      const size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero64(objects);
      for (size_t p = 0; p < kPlanes; ++p) {
        values_[p][count] = levels.level[0].Plane(block, p)[i];
      }
      ids_[count] = levels.ids[block * detail::kBlockObjects + i];
    }
    if (join_.has_margin && join_.near.dims == 0) GrowGathered(begin, count);
    return count;
  }

  HWY_NOINLINE void GrowGathered(size_t begin, size_t end) {
    const Tag d;
    for (size_t p = 0; p < kPlanes; ++p) {
      for (size_t j = begin; j < end; j += hn::Lanes(d)) {
        float* const values = values_[p] + j;
        hn::StoreU(Outward(d, p, hn::LoadU(d, values), join_.margins.data()), d,
                   values);
      }
    }
  }

  static uint64_t LowBits(size_t count) { return ~uint64_t{0} >> (64 - count); }

  // Compares each of some objects of a block with the gathered objects. With
  // kIsOwn, they are the first gathered objects, and each is compared with the
  // ones after it.
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
      if (join_.near.dims != 0) {
        SetNext(WriteNear<kIsSecond>(kEachPlane, levels, i, wanted, Next()));
        continue;
      }
      SetNext(CompareOne<kIsSecond>(kEachPlane, levels, i, begin, count, wanted,
                                    Next()));
    }
    return true;
  }

  template <bool kIsSecond, size_t... kPlane>
  HWY_NOINLINE uint32_t* WriteNear(std::index_sequence<kPlane...>,
                                   const detail::BvhLevels& levels, size_t i,
                                   uint64_t wanted, uint32_t* to) const {
    const float* const planes[] = {values_[kPlane]...};
    return WriteFew<kIsSecond>(
        levels.ids[i], KeepNear(levels.level[0], i, planes, wanted), ids_, to);
  }

  // The lanes of up to 64 objects that are near object i of a level, of those
  // whose bits are set.
  HWY_NOINLINE uint64_t KeepNear(const detail::BvhLevel& level, size_t i,
                                 const float* const* planes,
                                 uint64_t objects) const {
    const detail::NearLimit& limit = join_.near;
    const Tag d;
    const auto zero = hn::Zero(d);
    const auto gap_at = [&](size_t k, size_t j) HWY_ATTR {
      return GreaterOf(hn::Sub(hn::Set(d, level.Value(k, i)),
                               hn::LoadU(d, planes[kAxes + k] + j)),
                       GreaterOf(hn::Sub(hn::LoadU(d, planes[k] + j),
                                         hn::Set(d, level.Value(kAxes + k, i))),
                                 zero));
    };
    uint64_t far = 0;
    uint64_t sure = 0;
    for (size_t j = 0; j < 64 && objects >> j != 0; j += hn::Lanes(d)) {
      auto squared = zero;
      for (size_t k = 0; k < limit.dims; ++k) {
        const auto gap = gap_at(k, j);
        squared = hn::Add(squared, hn::Mul(gap, gap));
      }
      auto is_far = hn::Gt(squared, hn::Set(d, limit.beyond));
      if (limit.dims < kAxes) {
        is_far = hn::Or(is_far,
                        hn::Gt(gap_at(limit.dims, j), hn::Set(d, limit.d_gap)));
      }
      far |= LaneBits(d, is_far) << j;
      sure |= LaneBits(d, hn::Le(squared, hn::Set(d, limit.sure))) << j;
    }
    objects &= ~far;
    uint64_t unsure = objects & ~sure;
    if (unsure == 0) return objects;
    const kernels::FpMode<kernels::Rounding::kToNearest> mode;
    for (; unsure != 0; unsure &= unsure - 1) {
      const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(unsure);
      if (!IsNear(level, i, planes, lane)) objects &= ~(uint64_t{1} << lane);
    }
    return objects;
  }

  HWY_NOINLINE bool IsNear(const detail::BvhLevel& level, size_t i,
                           const float* const* planes, size_t lane) const {
    double squared = 0;
    for (size_t k = 0; k < join_.near.dims; ++k) {
      const double above = double{level.Value(k, i)} - planes[kAxes + k][lane];
      const double below = double{planes[k][lane]} - level.Value(kAxes + k, i);
      // Both are above 0 in an inverted box, and either can be NaN.
      double gap = above > 0 ? above : 0;
      if (below > gap) gap = below;
      squared += gap * gap;
    }
    return squared <= join_.near.squared;
  }

  HWY_INLINE bool HasRoom() const {
    detail::Results<IdPair>& pairs = *join_.pairs;
    return pairs.next < pairs.full || pairs.flush(pairs);
  }

  // Where the two ids of the next pair go.
  HWY_INLINE uint32_t* Next() const {
    return reinterpret_cast<uint32_t*>(join_.pairs->next);
  }
  HWY_INLINE void SetNext(uint32_t* next) const {
    join_.pairs->next = reinterpret_cast<IdPair*>(next);
  }

  // Compares object i with the wanted gathered objects from `begin` on.
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

  // The values are parameters, because the compiler would load values in memory
  // again after each store.
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

  // Writes the pairs of an id and the ids of some objects of a block.
  bool WriteAll(uint32_t id, uint64_t objects, const uint32_t* ids) const {
    if (!HasRoom()) return false;
    SetNext(WriteFew<false>(id, objects, ids, Next()));
    return true;
  }
  template <bool kIsSecond>
  static HWY_INLINE uint32_t* WriteFew(uint32_t id, uint64_t objects,
                                       const uint32_t* ids, uint32_t* to) {
    ForFewBits(objects, [&](size_t n, size_t bit) HWY_ATTR {
      to[2 * n] = kIsSecond ? ids[bit] : id;
      to[2 * n + 1] = kIsSecond ? id : ids[bit];
    });
    return to + 2 * hwy::PopCount(objects);
  }

  // Writes the pairs of an id and the ids of some gathered objects. If the
  // target has masks, these are the objects of one vector.
  template <bool kIsSecond>
  static HWY_INLINE uint32_t* WritePairs(uint32_t id, uint64_t objects,
                                         const uint32_t* ids, uint32_t* to) {
#if HALFSPACE_MASKED_COMPARES
    // Also if there are few pairs: a branch would be mispredicted.
    const __m512i one = _mm512_set1_epi32(static_cast<int32_t>(id));
    const __m512i others = _mm512_maskz_compress_epi32(
        static_cast<__mmask16>(objects), _mm512_loadu_si512(ids));
    StorePairs(kIsSecond ? others : one, kIsSecond ? one : others, to);
    return to + 2 * hwy::PopCount(objects);
#else
    return WriteFew<kIsSecond>(id, objects, ids, to);
#endif
  }

  static constexpr size_t kRoom = detail::kBlockObjects + hn::MaxLanes(Tag());

  const detail::PairJoin& join_;
  // Whether JoinEach() finds the pairs: of a set in a world of one level of
  // nodes, with no masks that are wanted and no margin.
  const bool is_plain_;
  uint32_t block_[detail::kWalkers];
  uint64_t members_[detail::kWalkers];
  uint32_t wanted_[detail::kWalkers];
  float bounds_[detail::kWalkers][kPlanes];
  size_t count_ = 0;
  size_t encoded_ = detail::kWalkers;  // the query that code_ is of, or none
  QueryCodes code_;
  bool is_room_clear_ = false;
  HWY_ALIGN float values_[kPlanes][kRoom];
  HWY_ALIGN uint32_t ids_[kRoom];
};

template <size_t kAxes>
void JoinPairs(const detail::PairJoin& join) {
  PairWalker<kAxes>(join).Run();
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_PAIRS_INL_H_
