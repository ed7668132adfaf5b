// Flat loops in the intrinsics of one instruction set, as somebody writes them
// who needs one bound on one machine: what a call of kernels.h is compared
// with.
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

// The loop for a target by its name; null if there is none.
LoopByHand LoopByHandOf(ShapeKind shape, std::string_view target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BY_HAND_H_
