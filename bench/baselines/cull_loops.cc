#include "bench/baselines/cull_loops.h"

#include <array>
#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define HALFSPACE_BENCH_INLINE [[gnu::always_inline]] inline
#define HALFSPACE_BENCH_RESTRICT __restrict__
#else
#define HALFSPACE_BENCH_INLINE inline
#define HALFSPACE_BENCH_RESTRICT
#endif

namespace halfspace::bench {
namespace {

constexpr std::size_t kSides = 6;

// The foremost corner is chosen once for each plane.
struct Corners {
  Corners(const float* const* planes, const HalfSpace3* frustum) {
    for (std::size_t f = 0; f < kSides; ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        from[f][k] = planes[frustum[f].normal[k] > 0 ? 3 + k : k];
      }
    }
  }
  const float* from[kSides][3];
};

// ---- For the compiler to vectorise, on each target.

HALFSPACE_BENCH_INLINE void PlainBoxes(
    const float* const* planes, std::size_t n, const HalfSpace3* frustum,
    std::uint8_t* HALFSPACE_BENCH_RESTRICT kept) {
  const Corners corners(planes, frustum);
  for (std::size_t i = 0; i < n; ++i) {
    int is_in = 1;
#pragma GCC unroll 6
    for (std::size_t f = 0; f < kSides; ++f) {
      const HalfSpace3& side = frustum[f];
      is_in &= corners.from[f][0][i] * side.normal[0] +
                           corners.from[f][1][i] * side.normal[1] +
                           corners.from[f][2][i] * side.normal[2] +
                           side.offset >=
                       0
                   ? 1
                   : 0;
    }
    kept[i] = static_cast<std::uint8_t>(is_in);
  }
}

// As Filament's culler has it: centers and half sizes, and absolute normals.
HALFSPACE_BENCH_INLINE void PlainCenters(
    const float* const* planes, std::size_t n, const HalfSpace3* frustum,
    std::uint8_t* HALFSPACE_BENCH_RESTRICT kept) {
  const float *x = planes[0], *y = planes[1], *z = planes[2];
  const float *half_x = planes[3], *half_y = planes[4], *half_z = planes[5];
  for (std::size_t i = 0; i < n; ++i) {
    int is_in = 1;
#pragma GCC unroll 6
    for (std::size_t f = 0; f < kSides; ++f) {
      const HalfSpace3& side = frustum[f];
      const float sum =
          side.normal[0] * x[i] + std::fabs(side.normal[0]) * half_x[i] +
          side.normal[1] * y[i] + std::fabs(side.normal[1]) * half_y[i] +
          side.normal[2] * z[i] + std::fabs(side.normal[2]) * half_z[i] +
          side.offset;
      is_in &= sum >= 0 ? 1 : 0;
    }
    kept[i] = static_cast<std::uint8_t>(is_in);
  }
}

HALFSPACE_BENCH_INLINE void PlainSpheres(
    const float* const* planes, std::size_t n, const HalfSpace3* frustum,
    std::uint8_t* HALFSPACE_BENCH_RESTRICT kept) {
  const float *x = planes[0], *y = planes[1], *z = planes[2];
  const float* radius = planes[3];
  for (std::size_t i = 0; i < n; ++i) {
    int is_in = 1;
#pragma GCC unroll 6
    for (std::size_t f = 0; f < kSides; ++f) {
      const HalfSpace3& side = frustum[f];
      is_in &= side.normal[0] * x[i] + side.normal[1] * y[i] +
                           side.normal[2] * z[i] + side.offset + radius[i] >=
                       0
                   ? 1
                   : 0;
    }
    kept[i] = static_cast<std::uint8_t>(is_in);
  }
}

#define HALFSPACE_BENCH_PLAIN(function, target)                          \
  target void function(const float* const* planes, std::size_t n,        \
                       const HalfSpace3* frustum, std::uint64_t* kept) { \
    Plain##function(planes, n, frustum,                                  \
                    reinterpret_cast<std::uint8_t*>(kept));              \
  }
#define HALFSPACE_BENCH_PLAIN_LOOPS(target) \
  HALFSPACE_BENCH_PLAIN(Boxes, target)      \
  HALFSPACE_BENCH_PLAIN(Centers, target)    \
  HALFSPACE_BENCH_PLAIN(Spheres, target)

namespace N_BASELINE {
HALFSPACE_BENCH_PLAIN_LOOPS()
}

constexpr std::array<CullLoop, 3> PlainLoops(
    void (*boxes)(const float* const*, std::size_t, const HalfSpace3*,
                  std::uint64_t*),
    void (*centers)(const float* const*, std::size_t, const HalfSpace3*,
                    std::uint64_t*),
    void (*spheres)(const float* const*, std::size_t, const HalfSpace3*,
                    std::uint64_t*)) {
  return {CullLoop{"plain loop", CullInput::kCorners, true, boxes},
          CullLoop{"plain loop of centers", CullInput::kCenters, true, centers},
          CullLoop{"plain loop", CullInput::kSpheres, true, spheres}};
}

#if defined(__x86_64__) && defined(__GNUC__)

// ---- By hand: 64 objects at a time, in order of planes.

namespace N_SSE4 {
HALFSPACE_BENCH_PLAIN_LOOPS([[gnu::target("sse4.2")]])
}  // namespace N_SSE4

namespace N_AVX2 {
HALFSPACE_BENCH_PLAIN_LOOPS([[gnu::target("avx2,fma")]])

// The sum's sign is its verdict. With kExit a word ends halfway if nothing of
// it is left.
template <bool kExit, bool kSpheres>
[[gnu::target("avx2,fma")]] void ByHand(const float* const* planes,
                                        std::size_t n,
                                        const HalfSpace3* frustum,
                                        std::uint64_t* kept) {
  const Corners corners(planes, frustum);
  for (std::size_t i = 0; i < n; i += 64) {
    __m256 out[8] = {};
    std::uint64_t rejected = 0;
    for (std::size_t f = 0; f < kSides; ++f) {
      const HalfSpace3& side = frustum[f];
      const __m256 normal_x = _mm256_set1_ps(side.normal[0]);
      const __m256 normal_y = _mm256_set1_ps(side.normal[1]);
      const __m256 normal_z = _mm256_set1_ps(side.normal[2]);
      const __m256 offset = _mm256_set1_ps(side.offset);
      const float* const x = (kSpheres ? planes[0] : corners.from[f][0]) + i;
      const float* const y = (kSpheres ? planes[1] : corners.from[f][1]) + i;
      const float* const z = (kSpheres ? planes[2] : corners.from[f][2]) + i;
#pragma GCC unroll 8
      for (std::size_t v = 0; v < 8; ++v) {
        __m256 sum =
            kSpheres
                ? _mm256_add_ps(_mm256_loadu_ps(planes[3] + i + 8 * v), offset)
                : offset;
        sum = _mm256_fmadd_ps(_mm256_loadu_ps(x + 8 * v), normal_x, sum);
        sum = _mm256_fmadd_ps(_mm256_loadu_ps(y + 8 * v), normal_y, sum);
        sum = _mm256_fmadd_ps(_mm256_loadu_ps(z + 8 * v), normal_z, sum);
        out[v] = _mm256_or_ps(out[v], sum);
      }
      if (f + 1 != kSides && !(kExit && f == 2)) continue;
      rejected = 0;
#pragma GCC unroll 8
      for (std::size_t v = 0; v < 8; ++v) {
        rejected |= std::uint64_t(unsigned(_mm256_movemask_ps(out[v])))
                    << (8 * v);
      }
      if (~rejected == 0) break;
    }
    *kept++ = ~rejected;
  }
}
}  // namespace N_AVX2

namespace N_AVX3 {
HALFSPACE_BENCH_PLAIN_LOOPS([[gnu::target("avx512f,avx512bw,avx512vl,fma")]])

template <bool kExit, bool kSpheres>
[[gnu::target("avx512f")]] void ByHand(const float* const* planes,
                                       std::size_t n, const HalfSpace3* frustum,
                                       std::uint64_t* kept) {
  const Corners corners(planes, frustum);
  for (std::size_t i = 0; i < n; i += 64) {
    __mmask16 left[4] = {0xffff, 0xffff, 0xffff, 0xffff};
    std::uint64_t word = 0;
    for (std::size_t f = 0; f < kSides; ++f) {
      const HalfSpace3& side = frustum[f];
      const __m512 normal_x = _mm512_set1_ps(side.normal[0]);
      const __m512 normal_y = _mm512_set1_ps(side.normal[1]);
      const __m512 normal_z = _mm512_set1_ps(side.normal[2]);
      const __m512 offset = _mm512_set1_ps(side.offset);
      const float* const x = (kSpheres ? planes[0] : corners.from[f][0]) + i;
      const float* const y = (kSpheres ? planes[1] : corners.from[f][1]) + i;
      const float* const z = (kSpheres ? planes[2] : corners.from[f][2]) + i;
#pragma GCC unroll 4
      for (std::size_t v = 0; v < 4; ++v) {
        __m512 sum =
            kSpheres
                ? _mm512_add_ps(_mm512_loadu_ps(planes[3] + i + 16 * v), offset)
                : offset;
        sum = _mm512_fmadd_ps(_mm512_loadu_ps(x + 16 * v), normal_x, sum);
        sum = _mm512_fmadd_ps(_mm512_loadu_ps(y + 16 * v), normal_y, sum);
        sum = _mm512_fmadd_ps(_mm512_loadu_ps(z + 16 * v), normal_z, sum);
        left[v] = _mm512_mask_cmp_ps_mask(left[v], sum, _mm512_setzero_ps(),
                                          _CMP_NLT_UQ);
      }
      if (f + 1 != kSides && !(kExit && f == 2)) continue;
      word = std::uint64_t{left[0]} | std::uint64_t{left[1]} << 16 |
             std::uint64_t{left[2]} << 32 | std::uint64_t{left[3]} << 48;
      if (word == 0) break;
    }
    *kept++ = word;
  }
}
}  // namespace N_AVX3

#define HALFSPACE_BENCH_LOOPS_BY_HAND(space)                        \
  CullLoop{"by hand", CullInput::kCorners, false,                   \
           &space::ByHand<false, false>},                           \
      CullLoop{"by hand, with an exit", CullInput::kCorners, false, \
               &space::ByHand<true, false>},                        \
      CullLoop{"by hand", CullInput::kSpheres, false,               \
               &space::ByHand<false, true>},                        \
      CullLoop {                                                    \
    "by hand, with an exit", CullInput::kSpheres, false,            \
        &space::ByHand<true, true>                                  \
  }

#endif

}  // namespace

std::vector<CullLoop> CullLoopsOf([[maybe_unused]] std::string_view target) {
  const auto with = [](const std::array<CullLoop, 3>& plain,
                       std::vector<CullLoop> loops) {
    loops.insert(loops.end(), plain.begin(), plain.end());
    return loops;
  };
#if defined(__x86_64__) && defined(__GNUC__)
  if (target == "AVX3") {
    return with(PlainLoops(&N_AVX3::Boxes, &N_AVX3::Centers, &N_AVX3::Spheres),
                {HALFSPACE_BENCH_LOOPS_BY_HAND(N_AVX3)});
  }
  if (target == "AVX2") {
    return with(PlainLoops(&N_AVX2::Boxes, &N_AVX2::Centers, &N_AVX2::Spheres),
                {HALFSPACE_BENCH_LOOPS_BY_HAND(N_AVX2)});
  }
  if (target == "SSE4") {
    return with(PlainLoops(&N_SSE4::Boxes, &N_SSE4::Centers, &N_SSE4::Spheres),
                {});
  }
#endif
  return with(PlainLoops(&N_BASELINE::Boxes, &N_BASELINE::Centers,
                         &N_BASELINE::Spheres),
              {});
}

}  // namespace halfspace::bench
