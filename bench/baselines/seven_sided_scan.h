// The box as the public aabo benchmark tests it, with a seventh side: its own
// up simplex first, then its maxima. It accepts what the box accepts.
#ifndef HALFSPACE_BENCH_BASELINES_SEVEN_SIDED_SCAN_H_
#define HALFSPACE_BENCH_BASELINES_SEVEN_SIDED_SCAN_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::bench {

// Writes the survivor mask of `size` boxes, a multiple of 64, in the way and
// the tiles of the library's octahedra by simplex: the minima of X, Y, Z and D,
// then the maxima of X, Y and Z of the words that have a survivor.
//   planes  aligned to 64 bytes: min X, min Y, min Z, min D, max X,
//           max Y, max Z
//   query   max X, max Y, max Z, max D, min X, min Y, min Z
using SevenSidedScan = void (*)(const float* const* planes, const float* query,
                                std::size_t size, std::uint64_t* mask);

// Of a supported target.
SevenSidedScan SevenSidedScanFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_SEVEN_SIDED_SCAN_H_
