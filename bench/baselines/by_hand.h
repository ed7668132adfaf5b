// Loops in the intrinsics of one instruction set, as somebody writes them who
// needs one bound on one machine: what the library's scans are compared with.
#ifndef HALFSPACE_BENCH_BASELINES_BY_HAND_H_
#define HALFSPACE_BENCH_BASELINES_BY_HAND_H_

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "bench/base/shape.h"

namespace halfspace::bench {

// As SurvivorsOf...() of kernels.h in 3 dimensions, of a multiple of 64
// objects.
using LoopByHand = void (*)(const float* const* planes, std::size_t n,
                            const float* query, std::uint64_t* mask);

// The flat loop for a target by its name; null if there is none.
LoopByHand LoopByHandOf(ShapeKind shape, std::string_view target);

// The loop for boxes that tests each axis only for the groups of 16 that have
// survived the axes before. Null without AVX-512 VBMI2.
LoopByHand StagedByHandOf(std::string_view target);

// Four queries over planes of bytes, as quantized simplices have them: 4 x 4
// values, and a mask each, `stride` words apart. An object survives if no plane
// is below the query's value.
using LevelsByHand = void (*)(const std::int8_t* const* planes, std::size_t n,
                              const std::int8_t* queries, std::uint64_t* masks,
                              std::size_t stride);
LevelsByHand LevelsByHandOf(std::string_view target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BY_HAND_H_
