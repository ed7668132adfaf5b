// The paper's schedule, which the library does not offer: after every
// half-space, a batch of `width` objects that are all rejected skips the rest.
// The same rule for all shapes.
#ifndef HALFSPACE_BENCH_BASELINES_GATED_SCAN_H_
#define HALFSPACE_BENCH_BASELINES_GATED_SCAN_H_

#include <cstddef>
#include <cstdint>

#include "bench/base/shape.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

inline constexpr std::size_t kWidestGate = 4096;

// Writes the reject mask of `size` objects. Planes and query as in the kernels:
// all minima, then all maxima. `width` is a power of two from the target's lane
// count to kWidestGate, `size` a multiple of kWidestGate.
using GatedScan = void (*)(ShapeKind shape, std::size_t width,
                           const float* const* planes, const float* query,
                           std::size_t size, std::uint64_t* mask);

// Of a supported target.
GatedScan GatedScanFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_GATED_SCAN_H_
