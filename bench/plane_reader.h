// Reads planes and does nothing else: the ceiling of a kernel whose world
// streams from memory.
#ifndef HALFSPACE_BENCH_PLANE_READER_H_
#define HALFSPACE_BENCH_PLANE_READER_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::bench {

enum class ReadOrder {
  kPlaneByPlane,  // one stream after the other
  kByWord,        // 64 floats of each plane in turn, as a flat kernel reads
};

// Reads `size` floats, a multiple of 64, of each plane. The
// result depends on every byte, so that no read can be left out.
using PlaneReader = std::uint32_t (*)(ReadOrder order,
                                      const float* const* planes,
                                      std::size_t plane_count,
                                      std::size_t size);

// Of a supported target.
PlaneReader PlaneReaderFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PLANE_READER_H_
