// What the flat kernels compute, and nothing loaded for it: their ceiling where
// the world sits in the first-level cache.
#ifndef HALFSPACE_BENCH_BASELINES_REGISTER_SCAN_H_
#define HALFSPACE_BENCH_BASELINES_REGISTER_SCAN_H_

#include <cstddef>
#include <cstdint>

#include "bench/base/shape.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

// The compares of the shape's planes, their joining and packing to bits, and
// the stores of the words of `size` objects, a multiple of 64: the code of the
// kernels itself, with a register where they load. Planes and query as in the
// kernels; planes are not read, so what is written means nothing.
using RegisterScan = void (*)(ShapeKind shape, const float* const* planes,
                              const float* query, std::size_t size,
                              std::uint64_t* mask);

// For one query at a time, and for several that share loads: with AVX-512 they
// differ in the width of vectors.
struct RegisterScans {
  RegisterScan one = nullptr;
  RegisterScan many = nullptr;
};

// Of a supported target. nullptr where no compiler offers what it takes: it is
// for SSE4, AVX2, AVX-512 and NEON, with gcc or clang.
RegisterScans RegisterScansFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_REGISTER_SCAN_H_
