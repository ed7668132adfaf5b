// Blocks of 64 objects or nodes: their codes, and the test of a query on them.
#if defined(HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
#undef HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hwy/highway.h"
#include "kernels/bvh/block.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Numbers beyond this are encoded as the ends of a scale that the others make.
// It also keeps a scale so small that flushed subnormals change no code.
inline constexpr float kMostScaled = 0x1p100f;

// The codes of scaled values that are numbers, less the bias.
template <class D>
HWY_INLINE hn::Vec<hn::Rebind<int32_t, D>> CodesOf(D d, hn::Vec<D> scaled) {
  const hn::Rebind<int32_t, D> di;
  const auto clamped =
      hn::Min(hn::Max(scaled, hn::Zero(d)),
              hn::Set(d, static_cast<float>(detail::kMostCode)));
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  // Highway's conversion mends what is out of range, in five instructions more.
  if constexpr (hn::MaxLanes(D()) == 8) {
    const decltype(hn::Zero(di)) truncated{_mm256_cvttps_epi32(clamped.raw)};
    return hn::Sub(truncated, hn::Set(di, detail::kCodeBias));
  }
#endif
  return hn::Sub(hn::ConvertTo(di, clamped), hn::Set(di, detail::kCodeBias));
}

// A query as blocks read it, in the lanes of BlockScale: the maxima, and the
// negated minima. A NaN, which never rejects, is +inf.
struct alignas(32) WalkQuery {
  float lanes[detail::BlockScale::kLanes];
};

template <size_t kAxes, bool kHasMax>
inline constexpr size_t kBlockPlanes = kHasMax ? 2 * kAxes : kAxes;
template <bool kHasMax>
inline constexpr size_t kQueryLanes =
    kHasMax ? detail::BlockScale::kLanes : detail::BlockScale::kMaxLane;

// Lanes of one vector are stored by one instruction: a load waits for stores of
// its parts.
template <size_t kAxes, bool kHasMax>
HWY_INLINE void ReadQuery(const float* values, WalkQuery& query) {
  constexpr size_t kLanes = kQueryLanes<kHasMax>;
  HWY_ALIGN float lanes[detail::BlockScale::kLanes] = {};
  const float* const maxima = kHasMax ? values + kAxes : values;
  for (size_t k = 0; k < kAxes; ++k) {
    lanes[k] = maxima[k];
    if (kHasMax) lanes[detail::BlockScale::kMaxLane + k] = -values[k];
  }
  const hn::CappedTag<float, kLanes> d;
  const auto inf = hn::Set(d, std::numeric_limits<float>::infinity());
  for (size_t l = 0; l < kLanes; l += hn::Lanes(d)) {
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
    const auto low =
        _mm_setr_ps(lanes[l], lanes[l + 1], lanes[l + 2], lanes[l + 3]);
    hn::Vec<decltype(d)> v;
#if HWY_TARGET <= HWY_AVX2
    if constexpr (kLanes == 8) {
      v.raw = _mm256_set_m128(
          _mm_setr_ps(lanes[l + 4], lanes[l + 5], lanes[l + 6], lanes[l + 7]),
          low);
    } else
#endif
      v.raw = low;
#else
    const auto v = hn::LoadU(d, lanes + l);
#endif
    hn::StoreU(hn::IfThenElse(hn::Eq(v, v), v, inf), d, query.lanes + l);
  }
}

// The codes of a query in a block: those above it, in lane order. Where
// shuffles of bytes spread them over a vector, they are in each of its blocks
// of 16 bytes.
#undef HALFSPACE_SHUFFLED_CODES
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
#define HALFSPACE_SHUFFLED_CODES 1
#else
#define HALFSPACE_SHUFFLED_CODES 0
#endif
struct QueryCodes {
#if HALFSPACE_SHUFFLED_CODES
  hn::Vec<WordTag<int8_t>> upper;
#else
  int8_t upper[detail::BlockScale::kLanes];
#endif
  // A code that is above the upper one by no more than this, which is negative,
  // is below the lower one.
  int8_t certain;
};

#if HALFSPACE_SHUFFLED_CODES
HWY_INLINE hn::Vec<WordTag<int8_t>> InEachBlock(__m128i bytes) {
#if HWY_TARGET <= HWY_AVX3
  return {_mm512_broadcast_i32x4(bytes)};
#elif HWY_TARGET == HWY_AVX2
  return {_mm256_broadcastsi128_si256(bytes)};
#else
  return {bytes};
#endif
}
#endif

template <size_t kLanes>
HWY_INLINE QueryCodes EncodeQuery(const detail::BlockScale& scale,
                                  const float* query) {
  const hn::CappedTag<float, kLanes> d;
  const hn::Rebind<int8_t, decltype(d)> d8;
  const hn::Rebind<int32_t, decltype(d)> di;
  const auto above = hn::Set(d, 1.0f + detail::kCodeMargin);
  const auto below = hn::Set(d, 1.0f - detail::kCodeMargin);
  QueryCodes codes;
  HWY_ALIGN int8_t bytes[16];
  bool differ = false;
  for (size_t l = 0; l < kLanes; l += hn::Lanes(d)) {
    const auto scaled =
        hn::Mul(hn::Sub(hn::LoadU(d, query + l), hn::LoadU(d, scale.base + l)),
                hn::LoadU(d, scale.scale + l));
    const auto upper = CodesOf(d, hn::Add(scaled, above));
    const auto lower = CodesOf(d, hn::Add(scaled, below));
    differ |= !hn::AllTrue(di, hn::Eq(upper, lower));
    const auto demoted = hn::DemoteTo(d8, upper);
#if HALFSPACE_SHUFFLED_CODES
    if constexpr (hn::MaxLanes(d) == kLanes) {
      codes.upper = InEachBlock(demoted.raw);
      continue;
    }
#endif
    hn::StoreU(demoted, d8, bytes + l);
  }
#if HALFSPACE_SHUFFLED_CODES
  if constexpr (hn::MaxLanes(d) != kLanes) {
    codes.upper =
        InEachBlock(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes)));
  }
#else
  hwy::CopyBytes<sizeof(codes.upper)>(bytes, codes.upper);
#endif
  codes.certain = static_cast<int8_t>(-1 - static_cast<int>(differ));
  return codes;
}

#if HALFSPACE_SHUFFLED_CODES
// Loaded, as gcc would make each by two instructions in each block.
#define HALFSPACE_16(lane)                                                  \
  {                                                                         \
    lane, lane, lane, lane, lane, lane, lane, lane, lane, lane, lane, lane, \
        lane, lane, lane, lane                                              \
  }
alignas(16) inline constexpr int8_t kSameLane[detail::BlockScale::kLanes][16] =
    {HALFSPACE_16(0), HALFSPACE_16(1), HALFSPACE_16(2), HALFSPACE_16(3),
     HALFSPACE_16(4), HALFSPACE_16(5), HALFSPACE_16(6), HALFSPACE_16(7)};
#undef HALFSPACE_16
#endif

template <class D>
HWY_INLINE hn::Vec<D> CodeOfLane(D d, const QueryCodes& query, size_t lane) {
#if HALFSPACE_SHUFFLED_CODES
  return hn::TableLookupBytes(query.upper, hn::LoadDup128(d, kSameLane[lane]));
#else
  return hn::Set(d, query.upper[lane]);
#endif
}

// Of a block of objects: bit i of `kept` says that no code rejects object i,
// and of `unsure` that its floats have to tell, though it is kept.
struct BlockBits {
  uint64_t kept;
  uint64_t unsure;
};

// The code of plane p in a query.
template <size_t kAxes>
constexpr size_t LaneOf(size_t p) {
  return p < kAxes ? p : detail::BlockScale::kMaxLane + p - kAxes;
}

// By how much the code of an object is above that of the query.
template <size_t kAxes, size_t kPlane, class D>
HWY_INLINE hn::Vec<D> Above(D d, const int8_t* codes, const QueryCodes& query) {
  return hn::SaturatedSub(hn::Load(d, codes + kPlane * detail::kBlockObjects),
                          CodeOfLane(d, query, LaneOf<kAxes>(kPlane)));
}

struct TakeMost {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};
struct TakeLeast {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};

// The most of that over kPlanes planes, or the least: where the most is
// positive, an object is rejected.
template <size_t kAxes, size_t kPlanes, class Take, class D>
HWY_INLINE hn::Vec<D> AboveOfPlanes(D d, Take take, const int8_t* codes,
                                    const QueryCodes& query) {
  const auto above = Above<kAxes, kPlanes - 1>(d, codes, query);
  if constexpr (kPlanes == 1) {
    return above;
  } else {
    return take(above,
                AboveOfPlanes<kAxes, kPlanes - 1>(d, take, codes, query));
  }
}

template <size_t kAxes, bool kHasMax>
HWY_INLINE BlockBits
TestBlock(const detail::Block<kBlockPlanes<kAxes, kHasMax>>& block,
          const WalkQuery& query) {
  const QueryCodes codes =
      EncodeQuery<kQueryLanes<kHasMax>>(block.scale, query.lanes);
  const WordTag<int8_t> d;
  const auto zero = hn::Zero(d);
  const auto certain = hn::Set(d, codes.certain);
  uint64_t rejected = 0;
  uint64_t not_certain = 0;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto above = AboveOfPlanes<kAxes, kBlockPlanes<kAxes, kHasMax>>(
        d, TakeMost(), &block.codes[0][i], codes);
    rejected |= LaneBits(d, hn::Gt(above, zero)) << i;
    not_certain |= LaneBits(d, hn::Gt(above, certain)) << i;
  }
  return {~rejected, not_certain & ~rejected};
}

// The bits of those of 64 objects or nodes that have one of some masks.
HWY_NOINLINE inline uint64_t MaskBits(const uint32_t* masks,
                                      uint32_t wanted_mask) {
  const WordTag<uint32_t> d;
  const auto wanted = hn::Set(d, wanted_mask);
  uint64_t bits = 0;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto common = hn::And(hn::LoadU(d, masks + i), wanted);
    bits |= LaneBits(d, hn::Ne(common, hn::Zero(d))) << i;
  }
  return bits;
}

// The bits of the objects or nodes inside a box or an octahedron: those whose
// minima are above its minima and whose maxima are below its maxima. `inverse`
// has the query's minima, and its negated maxima, in the lanes of WalkQuery.
template <size_t kAxes>
HWY_INLINE uint64_t InsideBits(const detail::Block<2 * kAxes>& block,
                               const WalkQuery& inverse) {
  const QueryCodes codes =
      EncodeQuery<kQueryLanes<true>>(block.scale, inverse.lanes);
  const WordTag<int8_t> d;
  uint64_t inside = 0;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto above = AboveOfPlanes<kAxes, 2 * kAxes>(
        d, TakeLeast(), &block.codes[0][i], codes);
    inside |= LaneBits(d, hn::Gt(above, hn::Zero(d))) << i;
  }
  return inside;
}

// A plane of a block as the least of what it stores; maxima are negated.
template <bool kIsMax, class D>
HWY_INLINE hn::Vec<D> LeastOf(D d, const float* plane) {
  const auto values = hn::LoadU(d, plane);
  return kIsMax ? hn::Neg(values) : values;
}

template <class D>
HWY_INLINE float LeastLane(D d, hn::Vec<D> values) {
#if HWY_TARGET == HWY_EMU128
  // Where all lanes are infinite, Highway 1.0.3 has FLT_MAX there.
  if (hn::AllTrue(d, hn::Eq(values, hn::Inf(d)))) return hn::GetLane(values);
#endif
  return hn::GetLane(hn::MinOfLanes(d, values));
}

// Encodes a plane, of which the objects in `present` exist. Returns the least
// value, which is -inf with a NaN.
template <bool kIsMax>
HWY_NOINLINE float EncodePlane(const float* plane, uint64_t present,
                               float& base, float& scale, int8_t* codes) {
  const hn::CappedTag<float, 16> d;
  const hn::Rebind<int8_t, decltype(d)> d8;
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const auto most = hn::Set(d, kInf);
  auto least = most;
  auto negated_greatest = most;
  bool all_scaled = true;
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto v = LeastOf<kIsMax>(d, plane + i);
    const auto is_scaled = hn::Le(hn::Abs(v), hn::Set(d, kMostScaled));
    all_scaled &= hn::AllTrue(d, is_scaled);
    least = hn::Min(least, hn::IfThenElse(is_scaled, v, most));
    negated_greatest =
        hn::Min(negated_greatest, hn::IfThenElse(is_scaled, hn::Neg(v), most));
  }
  // Never -0, of which and of 0 targets take one or the other.
  base = LeastLane(d, least) + 0.0f;
  float all_least = base;
  if (!all_scaled) {
    auto all = most;
    for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
      const auto v = LeastOf<kIsMax>(d, plane + i);
      all = hn::Min(all, hn::IfThenElse(hn::Eq(v, v), v, hn::Set(d, -kInf)));
    }
    all_least = LeastLane(d, all) + 0.0f;
  }
  // 0 - 0, and not -0, which would make a negative scale.
  const float range = 0.0f - LeastLane(d, negated_greatest) - base;
  scale = detail::kScaledCodes / range;
  if (!(scale <= kMostScaled)) scale = kMostScaled;
  if (!(base <= kMostScaled)) {  // nothing to scale
    base = 0;
    scale = 1;
  }
  const auto vbase = hn::Set(d, base);
  const auto vscale = hn::Set(d, scale);
  for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
    const auto v = LeastOf<kIsMax>(d, plane + i);
    const auto scaled =
        hn::Add(hn::Mul(hn::Sub(v, vbase), vscale), hn::Set(d, 1.0f));
    // A NaN never rejects.
    const auto number = hn::IfThenElseZero(hn::Eq(v, v), scaled);
    hn::StoreU(hn::DemoteTo(d8, CodesOf(d, number)), d8, codes + i);
  }
  for (uint64_t absent = ~present; absent != 0; absent &= absent - 1) {
    codes[hwy::Num0BitsBelowLS1Bit_Nonzero64(absent)] =
        static_cast<int8_t>(detail::kNoCode - detail::kCodeBias);
  }
  return all_least;
}

template <size_t kAxes>
HWY_INLINE bool IsRegular(const detail::BvhLevel& level, size_t block) {
  const size_t first = block * detail::kBlockObjects;
  const size_t count = HWY_MIN(detail::kBlockObjects, level.size - first);
  const uint64_t all = ~uint64_t{0} >> (detail::kBlockObjects - count);
  if (level.present[block] != all) return false;
  if (level.regular != nullptr) return level.regular[block] == all;
  const WordTag<float> d;
  bool is_regular = true;
  for (size_t k = 0; k < kAxes; ++k) {
    uint64_t ordered = 0;
    for (size_t i = 0; i < detail::kBlockObjects; i += hn::Lanes(d)) {
      const auto min = hn::LoadU(d, level.planes[k] + first + i);
      const auto max = hn::LoadU(d, level.planes[kAxes + k] + first + i);
      ordered |= LaneBits(d, hn::Le(min, max)) << i;
    }
    is_regular &= (ordered & all) == all;
  }
  return is_regular;
}

HWY_INLINE void AssignBit(uint64_t* words, size_t i, bool value) {
  const uint64_t bit = uint64_t{1} << (i % 64);
  words[i / 64] = value ? words[i / 64] | bit : words[i / 64] & ~bit;
}

template <size_t kAxes, bool kHasMax>
void EncodeBlocks(const detail::BlockRange& range) {
  using Block = detail::Block<kBlockPlanes<kAxes, kHasMax>>;
  const detail::BvhLevel& level = *range.level;
  auto* const blocks = reinterpret_cast<Block*>(level.blocks);
  for (size_t b = range.begin; b < range.end; ++b) {
    const size_t first = b * detail::kBlockObjects;
    const uint64_t present = level.present[b];
    detail::BlockScale scale;
    for (size_t l = 0; l < detail::BlockScale::kLanes; ++l) {
      scale.base[l] = -0.5f;  // lanes without an axis: queries have 0
      scale.scale[l] = 1.0f;
    }
    float least[detail::BlockScale::kLanes] = {};
    for (size_t k = 0; k < kAxes; ++k) {
      least[k] =
          EncodePlane<false>(level.planes[k] + first, present, scale.base[k],
                             scale.scale[k], blocks[b].codes[k]);
      if constexpr (kHasMax) {
        const size_t l = detail::BlockScale::kMaxLane + k;
        least[l] = EncodePlane<true>(level.planes[kAxes + k] + first, present,
                                     scale.base[l], scale.scale[l],
                                     blocks[b].codes[kAxes + k]);
      }
    }
    blocks[b].scale = scale;
    if (range.above == nullptr) continue;
    AssignBit(range.above->present, b, present != 0);
    if constexpr (kHasMax) {
      AssignBit(range.above->regular, b, IsRegular<kAxes>(level, b));
    }
    for (size_t k = 0; k < kAxes; ++k) {
      range.above->planes[k][b] = least[k];
      if constexpr (kHasMax) {
        range.above->planes[kAxes + k][b] =
            -least[detail::BlockScale::kMaxLane + k];
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_BLOCKS_INL_H_
