// Blocks of 64 objects or nodes. Computes their bounds and the codes of leaves,
// and tests them against queries.
#if defined(HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
#undef HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "hwy/highway.h"
#include "kernels/bvh/kernel_table.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The lowest level that has only one block. A tree with room for more objects
// has levels above it.
HWY_INLINE size_t TopLevel(const detail::BvhLevels& levels) {
  size_t top = levels.count - 1;
  while (top != 0 && levels.level[top - 1].size <= detail::kBlockObjects) --top;
  return top;
}

template <size_t kAxes, bool kHasMax>
inline constexpr size_t kBlockPlanes = kHasMax ? 2 * kAxes : kAxes;

// The lane of plane p in a CodeMap.
template <size_t kAxes>
constexpr size_t LaneOf(size_t p) {
  return p < kAxes ? p : detail::CodeMap::kMaxLane + p - kAxes;
}

// The codes of scaled values, less the bias.
template <class D>
HWY_INLINE hn::Vec<hn::Rebind<int32_t, D>> CodesOf(D d, hn::Vec<D> scaled) {
  const hn::Rebind<int32_t, D> di;
  const auto clamped =
      hn::Min(hn::Max(scaled, hn::Zero(d)),
              hn::Set(d, static_cast<float>(detail::kMostCode)));
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  // Highway's conversion handles values out of range, in five more
  // instructions.
  if constexpr (hn::MaxLanes(D()) == 8) {
    const decltype(hn::Zero(di)) truncated{_mm256_cvttps_epi32(clamped.raw)};
    return hn::Sub(truncated, hn::Set(di, detail::kCodeBias));
  }
#endif
  return hn::Sub(hn::ConvertTo(di, clamped), hn::Set(di, detail::kCodeBias));
}

// The value of a query that plane p is compared with, which is the opposite
// side of the same axis. A query has all minima, then all maxima. A query of
// simplices has only maxima.
template <size_t kAxes, size_t kPlanes>
constexpr size_t OpposingPlane(size_t p) {
  return (p + kAxes) % kPlanes;
}

struct QueryCodes {
  // The upper codes in the order of the lanes of a CodeMap. Each is stored
  // twice, so that one load fills a vector.
  alignas(32) int32_t upper[detail::CodeMap::kLanes];
  // An object certainly survives if none of its codes minus these is above this
  // number, which is negative.
  int16_t certain = -2;
};

// The values of a query in the lanes of a CodeMap. They are arguments of one
// instruction, because a load would wait for the stores of its parts.
template <size_t kAxes, bool kHasMax, class D>
HWY_INLINE hn::Vec<D> QueryLanes([[maybe_unused]] D d, const float* query,
                                 size_t first) {
  const auto value = [&](size_t lane) HWY_ATTR {
    constexpr size_t kMaxLane = detail::CodeMap::kMaxLane;
    const size_t k = lane % kMaxLane;
    if (k >= kAxes) return 0.0f;
    return lane < kMaxLane ? query[kHasMax ? kAxes + k : k] : -query[k];
  };
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
  const auto four = [&](size_t l) HWY_ATTR {
    return _mm_setr_ps(value(l), value(l + 1), value(l + 2), value(l + 3));
  };
  hn::Vec<D> lanes;
#if HWY_TARGET <= HWY_AVX2
  if constexpr (hn::MaxLanes(D()) == 8) {
    lanes.raw = _mm256_set_m128(four(first + 4), four(first));
    return lanes;
  } else
#endif
  {
    lanes.raw = four(first);
    return lanes;
  }
#else
  HWY_ALIGN float lanes[hn::MaxLanes(D())];
  for (size_t l = 0; l < hn::Lanes(d); ++l) lanes[l] = value(first + l);
  return hn::Load(d, lanes);
#endif
}

// Called once for each query and world, because all leaves share a map.
template <size_t kAxes, bool kHasMax>
HWY_INLINE void EncodeQuery(const detail::CodeMap& map, const float* query,
                            QueryCodes& codes) {
  constexpr size_t kLanes = detail::CodeMap::kLanes;
  const hn::CappedTag<float, kHasMax ? kLanes : detail::CodeMap::kMaxLane> d;
  const hn::Rebind<int32_t, decltype(d)> di;
  const auto margin = hn::Set(d, detail::kCodeMargin);
  auto differ = hn::Zero(di);
  for (size_t l = 0; l < (kHasMax ? kLanes : detail::CodeMap::kMaxLane);
       l += hn::Lanes(d)) {
    const auto values = QueryLanes<kAxes, kHasMax>(d, query, l);
    // A NaN never rejects, as if it were infinite.
    const auto numbers =
        hn::IfThenElse(hn::Eq(values, values), values, hn::Inf(d));
    const auto scaled = hn::Mul(hn::Sub(numbers, hn::LoadU(d, map.base + l)),
                                hn::LoadU(d, map.scale + l));
    const auto above = CodesOf(d, hn::Add(scaled, margin));
    differ =
        hn::Or(differ, hn::Xor(above, CodesOf(d, hn::Sub(scaled, margin))));
    const auto low = hn::And(above, hn::Set(di, 0xFFFF));
    hn::Store(hn::Or(low, hn::ShiftLeft<16>(low)), di, codes.upper + l);
  }
  codes.certain = hn::AllTrue(di, hn::Eq(differ, hn::Zero(di))) ? -1 : -2;
}

// The result for a leaf. Bit i of `kept` says that no code rejects object i.
// Bit i of `unsure` says that it is kept, but its floats have to be tested.
struct LeafBits {
  uint64_t kept;
  uint64_t unsure;
};

// The greatest difference between the codes of objects and the codes of the
// query, for one vector of objects. It is a chain of calls, so that each plane
// is loaded once.
template <size_t kAxes, size_t kPlane, class D>
HWY_INLINE hn::Vec<D> AboveQuery(D d, const int16_t* codes,
                                 const QueryCodes& query) {
  const hn::Repartition<int32_t, D> d32;
  const auto above = hn::SaturatedSub(
      hn::Load(d, codes + kPlane * detail::kBlockObjects),
      hn::BitCast(d, hn::Set(d32, query.upper[LaneOf<kAxes>(kPlane)])));
  if constexpr (kPlane == 0) {
    return above;
  } else {
    return hn::Max(above, AboveQuery<kAxes, kPlane - 1>(d, codes, query));
  }
}

template <size_t kAxes, size_t kPlanes>
HWY_INLINE LeafBits TestCodes(const int16_t* codes, const QueryCodes& query) {
  const WordTag<int16_t> d;
  const auto zero = hn::Zero(d);
  const auto certain = hn::Set(d, query.certain);
  uint64_t rejected = 0;
  uint64_t not_certain = 0;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto above = AboveQuery<kAxes, kPlanes - 1>(d, codes + i, query);
    rejected |= LaneBits(d, hn::Gt(above, zero)) << i;
    not_certain |= LaneBits(d, hn::Gt(above, certain)) << i;
  }
  return {~rejected, not_certain & ~rejected};
}

// The verdict bits of one vector of objects, from object i on, on planes
// kFirst, kFirst + 1, ...
template <size_t kMins, size_t kFirst, size_t kPlanes, size_t... kPlane>
HWY_INLINE uint64_t TestVector(std::index_sequence<kPlane...>,
                               const float* const* planes, size_t i,
                               const float* query) {
  const WordTag<float> d;
  return VerdictBits(
      d, Verdict<kMins>(d, LoadAll(), planes + kFirst, i,
                        hn::Set(d, query[OpposingPlane<kMins + kFirst, kPlanes>(
                                       kFirst + kPlane)])...));
}

// Tests the first `count` objects or nodes of a block, plane after plane. The
// first kMins planes reject if they are above the query's value. Bits beyond
// `count` may be set. With kIsSmall it takes less code, which is faster for few
// objects.
template <size_t kMins, bool kIsSmall, size_t... kPlane>
HWY_INLINE uint64_t TestPlanes(std::index_sequence<kPlane...>,
                               const float* const* planes, size_t count,
                               const float* query) {
  constexpr size_t kPlanes = sizeof...(kPlane);
  const WordTag<float> d;
  if (!kIsSmall && count > detail::kBlockObjects / 2) {
    return KeptBits<kMins>(
        d, LoadAll(), planes, 0,
        hn::Set(d, query[OpposingPlane<kMins, kPlanes>(kPlane)])...);
  }
  // Minima and maxima are two chains of compares: with few vectors, the latency
  // of one chain would decide the time of a query.
  constexpr size_t kMaxs = kPlanes - kMins;
  const size_t lanes = hn::Lanes(d);
  uint64_t bits = 0;
  for (size_t i = 0; i < count; i += lanes) {
    uint64_t some = TestVector<kMins, 0, kPlanes>(
        std::make_index_sequence<kMins>(), planes, i, query);
    if constexpr (kMaxs != 0) {
      const uint64_t others = TestVector<0, kMins, kPlanes>(
          std::make_index_sequence<kMaxs>(), planes, i, query);
      some = kVerdictIsKept<WordTag<float>> ? some & others : some | others;
    }
    if (!kVerdictIsKept<WordTag<float>>) some ^= ~uint64_t{0} >> (64 - lanes);
    bits |= some << i;
  }
  return bits;
}

template <size_t kAxes, size_t kPlanes, bool kIsSmall>
HWY_INLINE uint64_t TestBlock(const detail::BvhLevel& level, size_t block,
                              size_t first_plane, size_t count,
                              const float* query) {
  const float* planes[kPlanes];
  for (size_t p = 0; p < kPlanes; ++p) {
    planes[p] = level.Plane(block, (p + first_plane) % kPlanes);
  }
  return TestPlanes<kAxes, kIsSmall>(std::make_index_sequence<kPlanes>(),
                                     planes, count, query);
}

// The objects or nodes of a block that the floats do not reject.
template <size_t kAxes, bool kHasMax, bool kIsSmall = false>
HWY_INLINE uint64_t TestFloats(const detail::BvhLevel& level, size_t block,
                               const float* query) {
  return level.present[block] &
         TestBlock<kAxes, kBlockPlanes<kAxes, kHasMax>, kIsSmall>(
             level, block, 0, level.size - block * detail::kBlockObjects,
             query);
}

// The nodes inside a box or an octahedron: both their minima and their maxima
// are between the minima and maxima of the query.
template <size_t kAxes>
HWY_INLINE uint64_t InsideBits(const detail::BvhLevel& level, size_t block,
                               const float* query) {
  return TestBlock<kAxes, 2 * kAxes, false>(level, block, kAxes,
                                            detail::kBlockObjects, query);
}

// A bit for each of 64 objects or nodes whose mask has a bit of `mask`.
HWY_NOINLINE inline uint64_t MaskBits(const uint32_t* masks, uint32_t mask) {
  const WordTag<uint32_t> d;
  const auto wanted = hn::Set(d, mask);
  uint64_t bits = 0;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto common = hn::And(hn::LoadU(d, masks + i), wanted);
    bits |= LaneBits(d, hn::Ne(common, hn::Zero(d))) << i;
  }
  return bits;
}

// One vector of a plane; maxima are negated, so that the least value bounds the
// others.
template <bool kIsMax, class D>
HWY_INLINE hn::Vec<D> LeastOf(D d, const float* plane) {
  const auto values = hn::LoadU(d, plane);
  return kIsMax ? hn::Neg(values) : values;
}

template <class D>
HWY_INLINE float LeastLane(D d, hn::Vec<D> values) {
#if HWY_TARGET == HWY_EMU128
  // If all lanes are infinite, Highway 1.0.3 returns FLT_MAX.
  if (hn::AllTrue(d, hn::Eq(values, hn::Inf(d)))) return hn::GetLane(values);
#endif
  return hn::GetLane(hn::MinOfLanes(d, values));
}

// The least value of a plane, or -inf if there is a NaN. Never -0, because the
// minimum of 0 and -0 depends on the target.
template <bool kIsMax>
HWY_NOINLINE float LeastOfPlane(const float* plane) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const hn::CappedTag<float, 16> d;
  auto least = hn::Set(d, kInf);
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto v = LeastOf<kIsMax>(d, plane + i);
    const auto number = hn::IfThenElse(hn::Eq(v, v), v, hn::Set(d, -kInf));
    least = hn::Min(least, number);
  }
  return LeastLane(d, least) + 0.0f;
}

// Writes the codes of a plane. A NaN gets the least code, which rejects no
// query.
template <bool kIsMax>
HWY_NOINLINE void EncodePlane(const float* plane, float base, float scale,
                              int16_t* codes) {
  const hn::CappedTag<float, 16> d;
  const hn::Rebind<int16_t, decltype(d)> d16;
  const auto vbase = hn::Set(d, base);
  const auto vscale = hn::Set(d, scale);
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto v = LeastOf<kIsMax>(d, plane + i);
    const auto scaled = hn::Mul(hn::Sub(v, vbase), vscale);
    const auto number = hn::IfThenElseZero(hn::Eq(v, v), scaled);
    hn::StoreU(hn::DemoteTo(d16, CodesOf(d, number)), d16, codes + i);
  }
}

// Writes the outermost values of a block, in the order of its planes. They are
// right if there is no NaN. Returns whether min <= max on each axis of all 64
// lanes. If so, there is no NaN.
template <size_t kAxes>
HWY_INLINE bool OutermostOf(const detail::BvhLevel& level, size_t block,
                            float* outermost) {
  const hn::CappedTag<float, 16> d;
  auto ordered = hn::Le(hn::Zero(d), hn::Zero(d));
  for (size_t k = 0; k < kAxes; ++k) {
    const float* const minima = level.Plane(block, k);
    const float* const maxima = level.Plane(block, kAxes + k);
    auto least = hn::LoadU(d, minima);
    auto greatest = hn::LoadU(d, maxima);
    ordered = hn::And(ordered, hn::Le(least, greatest));
    for (size_t i = hn::Lanes(d); i < detail::kBlockObjects;
         i += hn::Lanes(d)) {
      const auto min = hn::LoadU(d, minima + i);
      const auto max = hn::LoadU(d, maxima + i);
      ordered = hn::And(ordered, hn::Le(min, max));
      least = hn::Min(least, min);
      greatest = hn::Max(greatest, max);
    }
    outermost[k] = LeastLane(d, least) + 0.0f;
    outermost[kAxes + k] = -(LeastLane(d, hn::Neg(greatest)) + 0.0f);
  }
  return hn::AllTrue(d, ordered);
}

// An erased object is inverted, and has no NaN.
template <size_t kPlanes>
HWY_INLINE bool HasNaN(const detail::BvhLevel& level, size_t block) {
  const hn::CappedTag<float, 16> d;
  const float* const values = level.Plane(block, 0);
  auto numbers = hn::Eq(hn::Zero(d), hn::Zero(d));
  for (size_t i = 0; i < kPlanes * detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto v = hn::LoadU(d, values + i);
    numbers = hn::And(numbers, hn::Eq(v, v));
  }
  return !hn::AllTrue(d, numbers);
}

// Whether all lanes up to the last object have an object with min <= max on
// each axis.
template <size_t kAxes>
HWY_NOINLINE bool IsRegular(const detail::BvhLevel& level, size_t block) {
  const size_t first = block * detail::kBlockObjects;
  const size_t count = HWY_MIN(detail::kBlockObjects, level.size - first);
  const uint64_t all = ~uint64_t{0} >> (detail::kBlockObjects - count);
  if (level.present[block] != all) return false;
  if (level.regular != nullptr) return level.regular[block] == all;
  const hn::CappedTag<float, 16> d;
  uint64_t left = all;
  for (size_t i = 0; left != 0; i += hn::Lanes(d), left >>= hn::Lanes(d)) {
    auto ordered = hn::Le(hn::LoadU(d, level.Plane(block, 0) + i),
                          hn::LoadU(d, level.Plane(block, kAxes) + i));
    for (size_t k = 1; k < kAxes; ++k) {
      ordered = hn::And(
          ordered, hn::Le(hn::LoadU(d, level.Plane(block, k) + i),
                          hn::LoadU(d, level.Plane(block, kAxes + k) + i)));
    }
    if ((left & LaneBits(d, hn::Not(ordered))) != 0) return false;
  }
  return true;
}

// If more objects of a block have changed, all of it is encoded.
inline constexpr size_t kMostOneByOne = 16;

// Writes the codes of all objects of a block.
template <size_t kAxes, bool kHasMax>
HWY_INLINE void EncodeAll(const detail::BlockRange& range, size_t block,
                          int16_t* codes) {
  constexpr size_t kMaxLane = detail::CodeMap::kMaxLane;
  const detail::BvhLevel& level = *range.level;
  const detail::CodeMap& map = *range.map;
  for (size_t k = 0; k < kAxes; ++k) {
    EncodePlane<false>(level.Plane(block, k), map.base[k], map.scale[k],
                       codes + k * detail::kBlockObjects);
    if constexpr (kHasMax) {
      EncodePlane<true>(level.Plane(block, kAxes + k), map.base[kMaxLane + k],
                        map.scale[kMaxLane + k],
                        codes + (kAxes + k) * detail::kBlockObjects);
    }
  }
}

// Writes the codes of the objects whose bits are set. All planes of an object
// are encoded at once.
template <size_t kAxes, bool kHasMax>
HWY_INLINE void EncodeSome(const detail::BlockRange& range, size_t block,
                           uint64_t objects, int16_t* codes) {
  constexpr size_t kLanes =
      kHasMax ? detail::CodeMap::kLanes : detail::CodeMap::kMaxLane;
  constexpr size_t kPlanes = kBlockPlanes<kAxes, kHasMax>;
  const hn::CappedTag<float, kLanes> d;
  const hn::Rebind<int32_t, decltype(d)> di;
  const float* const floats = range.level->Plane(block, 0);
  for (; objects != 0; objects &= objects - 1) {
    const size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero64(objects);
    // QueryLanes() takes the maxima of a query first.
    float values[kPlanes];
    for (size_t p = 0; p < kPlanes; ++p) {
      values[OpposingPlane<kAxes, kPlanes>(p)] =
          floats[p * detail::kBlockObjects + i];
    }
    HWY_ALIGN int32_t lanes[kLanes];
    for (size_t l = 0; l < kLanes; l += hn::Lanes(d)) {
      const auto v = QueryLanes<kAxes, kHasMax>(d, values, l);
      const auto scaled = hn::Mul(hn::Sub(v, hn::LoadU(d, range.map->base + l)),
                                  hn::LoadU(d, range.map->scale + l));
      const auto number = hn::IfThenElseZero(hn::Eq(v, v), scaled);
      hn::Store(CodesOf(d, number), di, lanes + l);
    }
    for (size_t p = 0; p < kPlanes; ++p) {
      codes[p * detail::kBlockObjects + i] =
          static_cast<int16_t>(lanes[LaneOf<kAxes>(p)]);
    }
  }
}

// Returns whether the bit changed.
HWY_INLINE bool AssignBit(uint64_t* words, size_t i, bool value) {
  const uint64_t bit = uint64_t{1} << (i % 64);
  const uint64_t old = words[i / 64];
  words[i / 64] = value ? old | bit : old & ~bit;
  return ((old & bit) != 0) != value;
}

// Writes the node of a block, except its masks. Returns whether the node
// changed.
template <size_t kAxes, bool kHasMax>
HWY_INLINE bool EncodeNode(const detail::BvhLevel& level, size_t block,
                           const detail::BvhLevel& above) {
  constexpr size_t kPlanes = kBlockPlanes<kAxes, kHasMax>;
  bool is_changed = AssignBit(above.present, block, level.present[block] != 0);
  float planes[kPlanes];
  bool is_right = false;
  if constexpr (kHasMax) {
    const bool is_ordered = OutermostOf<kAxes>(level, block, planes);
    const bool is_regular = (is_ordered && level.regular == nullptr) ||
                            IsRegular<kAxes>(level, block);
    is_changed |= AssignBit(above.regular, block, is_regular);
    is_right = is_ordered || !HasNaN<kPlanes>(level, block);
  }
  if (!is_right) {
    for (size_t k = 0; k < kAxes; ++k) {
      planes[k] = LeastOfPlane<false>(level.Plane(block, k));
      if constexpr (kHasMax) {
        planes[kAxes + k] = -LeastOfPlane<true>(level.Plane(block, kAxes + k));
      }
    }
  }
  for (size_t p = 0; p < kPlanes; ++p) {
    float& node = above.Value(p, block);
    is_changed |= node != planes[p];
    node = planes[p];
  }
  return is_changed;
}

template <size_t kAxes, bool kHasMax>
void EncodeBlocks(const detail::BlockRange& range) {
  constexpr size_t kPlanes = kBlockPlanes<kAxes, kHasMax>;
  const detail::BvhLevel& level = *range.level;
  // Skips eight unchanged blocks at a time, because a list of changes may touch
  // few blocks.
  const auto are_unchanged = [&range](size_t b) HWY_ATTR {
    const uint64_t* const words = range.changed + (b - range.begin);
    uint64_t any = 0;
    for (size_t i = 0; i < 8; ++i) any |= words[i];
    return any == 0;
  };
  for (size_t b = range.begin; b < range.end; ++b) {
    while (range.changed != nullptr && b + 8 < range.end && are_unchanged(b)) {
      b += 8;
    }
    const uint64_t changed = range.changed == nullptr
                                 ? ~uint64_t{0}
                                 : range.changed[b - range.begin];
    if (changed == 0) continue;
    if (range.codes != nullptr) {
      int16_t* const codes = range.codes + b * kPlanes * detail::kBlockObjects;
      if (hwy::PopCount(changed) > kMostOneByOne) {
        EncodeAll<kAxes, kHasMax>(range, b, codes);
      } else {
        EncodeSome<kAxes, kHasMax>(range, b, changed, codes);
      }
    }
    if (range.above == nullptr) continue;
    bool is_changed = EncodeNode<kAxes, kHasMax>(level, b, *range.above);
    if (range.changed == nullptr) continue;
    if (level.masks != nullptr) {
      uint32_t& node = range.above->masks[b];
      const uint32_t masks = level.MasksOf(b);
      is_changed |= node != masks;
      node = masks;
    }
    range.changed_above[b / 64 - range.begin / 64] |= uint64_t{is_changed}
                                                      << (b % 64);
  }
}

// The lane is in the lowest bits of a growth, so the least number has both.
// Growths that differ by less than 2^-17 of their size count as equal.
template <size_t kAxes, bool kHasMax>
size_t NearestNode(const detail::BvhLevel& level, size_t block,
                   const float* values, uint64_t nodes) {
  constexpr int32_t kLaneBits = detail::kBlockObjects - 1;
  const hn::CappedTag<float, 16> d;
  const hn::Rebind<int32_t, decltype(d)> di;
  const auto lanes = hn::Iota(di, 0);
  const auto bits = hn::Shl(hn::Set(di, 1), lanes);
  const auto none = hn::Set(di, std::numeric_limits<int32_t>::max());
  auto least = none;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    auto growth = hn::Zero(d);
    // A NaN is no growth.
    const auto add = [&](hn::Vec<decltype(d)> beyond) HWY_ATTR {
      growth = hn::Add(growth,
                       hn::IfThenElseZero(hn::Gt(beyond, hn::Zero(d)), beyond));
    };
    for (size_t p = 0; p < kBlockPlanes<kAxes, kHasMax>; ++p) {
      const auto plane = hn::LoadU(d, level.Plane(block, p) + i);
      const auto value = hn::Set(d, values[p]);
      add(p < kAxes ? hn::Sub(plane, value) : hn::Sub(value, plane));
    }
    if constexpr (!kHasMax && kAxes == 4) {
      // The simplex around a cube has 4.5 times its volume. Its objects are in
      // the cube, whose edge is a third of the simplex's. If it did not count
      // how far an object is beyond the cube, the objects would spread over the
      // simplex when they are sorted, and then over the next one. Triangles,
      // which have twice the area of their squares, decay more with this term.
      constexpr size_t kDims = kAxes - 1;
      auto edge = hn::Zero(d);
      for (size_t p = 0; p < kAxes; ++p) {
        edge = hn::Sub(edge, hn::LoadU(d, level.Plane(block, p) + i));
      }
      edge = hn::Mul(edge, hn::Set(d, 1.0f / kDims));
      for (size_t p = 0; p < kDims; ++p) {
        const auto plane = hn::LoadU(d, level.Plane(block, p) + i);
        add(hn::Sub(hn::Sub(hn::Set(d, values[p]), plane), edge));
      }
    }
    const auto key =
        hn::Or(hn::AndNot(hn::Set(di, kLaneBits), hn::BitCast(di, growth)),
               hn::Add(lanes, hn::Set(di, static_cast<int32_t>(i))));
    const auto counts =
        hn::TestBit(hn::Set(di, static_cast<int32_t>(nodes >> i)), bits);
    least = hn::Min(least, hn::IfThenElse(counts, key, none));
  }
  return static_cast<size_t>(hn::GetLane(hn::MinOfLanes(di, least)) &
                             kLaneBits);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
