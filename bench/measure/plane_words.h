// Which objects each plane of an octahedron rejects by itself, as mask words:
// what the work metric counts in.
#ifndef HALFSPACE_BENCH_MEASURE_PLANE_WORDS_H_
#define HALFSPACE_BENCH_MEASURE_PLANE_WORDS_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::bench {

inline constexpr std::size_t kPlaneWordsPlanes = 8;

// Plane p of objects i ... i + 63: all minima (X, Y, Z, D), then all maxima.
using PlaneWords = std::array<std::uint64_t, kPlaneWordsPlanes>;

// Fills `words` words from object 0 of the planes on, all full.
using PlaneWordsFunction = void (*)(const float* const* planes,
                                    const float* query, std::size_t words,
                                    PlaneWords* out);

// Of a supported target.
PlaneWordsFunction PlaneWordsFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_MEASURE_PLANE_WORDS_H_
