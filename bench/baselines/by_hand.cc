#include "bench/baselines/by_hand.h"

#include <algorithm>
#include <array>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#elif defined(__aarch64__) && defined(__GNUC__)
#include <arm_neon.h>
#endif

namespace halfspace::bench {
namespace {

// The namespaces are those of Highway's targets: a test looks there alone for
// instructions above the baseline. Each loop has kMins minima, which are
// compared with the query's maxima, and kMaxs maxima. What is rejected is
// collected by OR, and turned round once a word.

#if defined(__x86_64__) && defined(__GNUC__)

namespace N_AVX2 {
template <std::size_t kMins, std::size_t kMaxs>
[[gnu::target("avx2")]] void Test(const float* const* planes, std::size_t n,
                                  const float* query, std::uint64_t* mask) {
  const float* const max = query + (kMaxs == 0 ? 0 : kMins);
  __m256 values[kMins + kMaxs];
  for (std::size_t p = 0; p < kMins; ++p) values[p] = _mm256_set1_ps(max[p]);
  for (std::size_t p = 0; p < kMaxs; ++p) {
    values[kMins + p] = _mm256_set1_ps(query[p]);
  }
  for (std::size_t i = 0; i < n; i += 64) {
    std::uint64_t rejected = 0;
#pragma GCC unroll 8
    for (std::size_t l = 0; l < 64; l += 8) {
      __m256 bits = _mm256_setzero_ps();
#pragma GCC unroll 8
      for (std::size_t p = 0; p < kMins + kMaxs; ++p) {
        const __m256 objects = _mm256_loadu_ps(planes[p] + i + l);
        const __m256 is_less =
            p < kMins ? _mm256_cmp_ps(values[p], objects, _CMP_LT_OQ)
                      : _mm256_cmp_ps(objects, values[p], _CMP_LT_OQ);
        bits = p == 0 ? is_less : _mm256_or_ps(bits, is_less);
      }
      rejected |= std::uint64_t(unsigned(_mm256_movemask_ps(bits))) << l;
    }
    *mask++ = ~rejected;
  }
}
}  // namespace N_AVX2

namespace N_AVX3 {
template <std::size_t kMins, std::size_t kMaxs>
[[gnu::target("avx512f")]] void Test(const float* const* planes, std::size_t n,
                                     const float* query, std::uint64_t* mask) {
  const float* const max = query + (kMaxs == 0 ? 0 : kMins);
  __m512 values[kMins + kMaxs];
  for (std::size_t p = 0; p < kMins; ++p) values[p] = _mm512_set1_ps(max[p]);
  for (std::size_t p = 0; p < kMaxs; ++p) {
    values[kMins + p] = _mm512_set1_ps(query[p]);
  }
  for (std::size_t i = 0; i < n; i += 64) {
    std::uint64_t kept = 0;
#pragma GCC unroll 4
    for (std::size_t l = 0; l < 64; l += 16) {
      __mmask16 bits = 0xffff;
#pragma GCC unroll 8
      for (std::size_t p = 0; p < kMins + kMaxs; ++p) {
        const __m512 objects = _mm512_loadu_ps(planes[p] + i + l);
        bits = p < kMins ? _mm512_mask_cmp_ps_mask(bits, objects, values[p],
                                                   _CMP_NGT_UQ)
                         : _mm512_mask_cmp_ps_mask(bits, objects, values[p],
                                                   _CMP_NLT_UQ);
      }
      kept |= std::uint64_t{bits} << l;
    }
    *mask++ = kept;
  }
}

// Keeps the numbers of the groups of 16 objects that have a bit. Returns how
// many are left.
[[gnu::target("avx512f,avx512bw,avx512vbmi2,popcnt")]] std::size_t KeepGroups(
    const std::uint16_t* bits, const std::uint16_t* groups, std::size_t count,
    std::uint16_t* left) {
  std::size_t some = 0;
  for (std::size_t j = 0; j < count; j += 32) {
    const __mmask32 in =
        ~__mmask32{0} >> (32 - std::min<std::size_t>(32, count - j));
    const __m512i kept = _mm512_maskz_loadu_epi16(in, bits + j);
    const __mmask32 is_left = _mm512_test_epi16_mask(kept, kept);
    _mm512_storeu_si512(
        left + some,
        _mm512_maskz_compress_epi16(is_left, _mm512_loadu_si512(groups + j)));
    some += static_cast<std::size_t>(_mm_popcnt_u32(is_left));
  }
  return some;
}

[[gnu::target("avx512f,avx512bw,avx512vbmi2,popcnt")]] void TestStaged(
    const float* const* planes, std::size_t n, const float* query,
    std::uint64_t* mask) {
  constexpr std::size_t kTile = 4096;
  using GroupList = std::array<std::uint16_t, kTile / 16 + 32>;
  static constexpr GroupList kAllGroups = [] {
    GroupList groups{};
    for (std::size_t g = 0; g < groups.size(); ++g) {
      groups[g] = static_cast<std::uint16_t>(g);
    }
    return groups;
  }();
  GroupList groups;
  GroupList bits;
  for (std::size_t i = 0; i < n; i += kTile, mask += kTile / 64) {
    auto* const row = reinterpret_cast<__mmask16*>(mask);
    std::size_t count = std::min(n - i, kTile) / 16;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* const min = planes[axis] + i;
      const float* const max = planes[3 + axis] + i;
      const __m512 above = _mm512_set1_ps(query[3 + axis]);
      const __m512 below = _mm512_set1_ps(query[axis]);
      if (axis == 0) {
#pragma GCC unroll 4
        for (std::size_t g = 0; g < count; ++g) {
          const __mmask16 kept = _mm512_cmp_ps_mask(
              _mm512_loadu_ps(min + 16 * g), above, _CMP_NGT_UQ);
          _store_mask16(row + g, _mm512_mask_cmp_ps_mask(
                                     kept, _mm512_loadu_ps(max + 16 * g), below,
                                     _CMP_NLT_UQ));
        }
        count = KeepGroups(row, kAllGroups.data(), count, groups.data());
        continue;
      }
#pragma GCC unroll 2
      for (std::size_t j = 0; j < count; ++j) {
        const std::size_t g = groups[j];
        __mmask16 kept = _mm512_mask_cmp_ps_mask(_load_mask16(row + g),
                                                 _mm512_loadu_ps(min + 16 * g),
                                                 above, _CMP_NGT_UQ);
        kept = _mm512_mask_cmp_ps_mask(kept, _mm512_loadu_ps(max + 16 * g),
                                       below, _CMP_NLT_UQ);
        _store_mask16(row + g, kept);
        _store_mask16(reinterpret_cast<__mmask16*>(&bits[j]), kept);
      }
      if (axis == 1) {
        count = KeepGroups(bits.data(), groups.data(), count, groups.data());
      }
    }
  }
}

// Four queries share each load of four planes. An object below a query is
// rejected.
[[gnu::target("avx512f,avx512bw")]] void TestLevels(
    const std::int8_t* const* planes, std::size_t n, const std::int8_t* queries,
    std::uint64_t* masks, std::size_t stride) {
  __m512i values[4][4];
  for (std::size_t v = 0; v < 16; ++v) {
    values[v / 4][v % 4] = _mm512_set1_epi8(queries[v]);
  }
  for (std::size_t i = 0; i < n; i += 64, ++masks) {
    __m512i objects[4];
#pragma GCC unroll 4
    for (std::size_t p = 0; p < 4; ++p) {
      objects[p] = _mm512_loadu_si512(planes[p] + i);
    }
#pragma GCC unroll 4
    for (std::size_t q = 0; q < 4; ++q) {
      __m512i rejected = _mm512_setzero_si512();
#pragma GCC unroll 4
      for (std::size_t p = 0; p < 4; ++p) {
        const __m512i lesser = _mm512_min_epi8(objects[p], values[q][p]);
        rejected =
            _mm512_ternarylogic_epi32(rejected, lesser, values[q][p], 0xf6);
      }
      masks[q * stride] = _mm512_testn_epi8_mask(rejected, rejected);
    }
  }
}
}  // namespace N_AVX3

template <std::size_t kMins, std::size_t kMaxs>
LoopByHand LoopOf(std::string_view target) {
  if (target == "AVX2") return &N_AVX2::Test<kMins, kMaxs>;
  if (target == "AVX3") return &N_AVX3::Test<kMins, kMaxs>;
  return nullptr;
}

#elif defined(__aarch64__) && defined(__GNUC__)

namespace N_NEON {
template <std::size_t kMins, std::size_t kMaxs>
void Test(const float* const* planes, std::size_t n, const float* query,
          std::uint64_t* mask) {
  const float* const max = query + (kMaxs == 0 ? 0 : kMins);
  float32x4_t values[kMins + kMaxs];
  for (std::size_t p = 0; p < kMins; ++p) values[p] = vdupq_n_f32(max[p]);
  for (std::size_t p = 0; p < kMaxs; ++p) {
    values[kMins + p] = vdupq_n_f32(query[p]);
  }
  const uint8x16_t bit_of_lane = vreinterpretq_u8_u64(
      vdupq_n_u64(0x8040201008040201));  // 1, 2, 4 ... 128, twice
  for (std::size_t i = 0; i < n; i += 64) {
    uint8x16_t bits[4];
#pragma GCC unroll 4
    for (std::size_t b = 0; b < 4; ++b) {
      uint32x4_t rejected[4];
#pragma GCC unroll 4
      for (std::size_t v = 0; v < 4; ++v) {
#pragma GCC unroll 8
        for (std::size_t p = 0; p < kMins + kMaxs; ++p) {
          const float32x4_t objects = vld1q_f32(planes[p] + i + 16 * b + 4 * v);
          const uint32x4_t is_less = p < kMins ? vcltq_f32(values[p], objects)
                                               : vcltq_f32(objects, values[p]);
          rejected[v] = p == 0 ? is_less : vorrq_u32(rejected[v], is_less);
        }
      }
      // The even halves of two vectors: lanes of 16 bits, then of 8.
      const uint16x8_t low = vuzp1q_u16(vreinterpretq_u16_u32(rejected[0]),
                                        vreinterpretq_u16_u32(rejected[1]));
      const uint16x8_t high = vuzp1q_u16(vreinterpretq_u16_u32(rejected[2]),
                                         vreinterpretq_u16_u32(rejected[3]));
      bits[b] = vandq_u8(
          vuzp1q_u8(vreinterpretq_u8_u16(low), vreinterpretq_u8_u16(high)),
          bit_of_lane);
    }
    // Three sums of neighbours turn 64 lanes into 64 bits.
    uint8x16_t sum =
        vpaddq_u8(vpaddq_u8(bits[0], bits[1]), vpaddq_u8(bits[2], bits[3]));
    sum = vpaddq_u8(sum, sum);
    *mask++ = ~vgetq_lane_u64(vreinterpretq_u64_u8(sum), 0);
  }
}
}  // namespace N_NEON

template <std::size_t kMins, std::size_t kMaxs>
LoopByHand LoopOf(std::string_view target) {
  if (target == "NEON" || target == "NEON_WITHOUT_AES") {
    return &N_NEON::Test<kMins, kMaxs>;
  }
  return nullptr;
}

#else

template <std::size_t kMins, std::size_t kMaxs>
LoopByHand LoopOf(std::string_view /*target*/) {
  return nullptr;
}

#endif

}  // namespace

LoopByHand StagedByHandOf([[maybe_unused]] std::string_view target) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (target == "AVX3" && __builtin_cpu_supports("avx512vbmi2") != 0) {
    return &N_AVX3::TestStaged;
  }
#endif
  return nullptr;
}

LevelsByHand LevelsByHandOf([[maybe_unused]] std::string_view target) {
#if defined(__x86_64__) && defined(__GNUC__)
  if (target == "AVX3") return &N_AVX3::TestLevels;
#endif
  return nullptr;
}

LoopByHand LoopByHandOf(ShapeKind shape, std::string_view target) {
  switch (shape) {
    case ShapeKind::kAabb:
      return LoopOf<3, 3>(target);
    case ShapeKind::kSimplex:
      return LoopOf<4, 0>(target);
    case ShapeKind::kAabo:
      break;
  }
  return LoopOf<4, 4>(target);
}

}  // namespace halfspace::bench
