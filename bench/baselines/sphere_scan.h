// Bounding spheres, which the library does not store: 4 planes, the center's
// and the radius', and a test that computes.
#ifndef HALFSPACE_BENCH_BASELINES_SPHERE_SCAN_H_
#define HALFSPACE_BENCH_BASELINES_SPHERE_SCAN_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/targets.h"

namespace halfspace::bench {

// Writes the survivor mask of `size` spheres, a multiple of 64. Planes, aligned
// to 64 bytes, and query: x, y, z, radius.
using SphereScan = void (*)(const float* const* planes, const float* query,
                            std::size_t size, std::uint64_t* mask);

struct SphereScans {
  // Rejects by the squared distance of the centers, against the square of the
  // sum of the radii.
  SphereScan flat = nullptr;

  // The same for those batches in which one is near enough along x. Tiles and
  // batches are those of the library's boxes by axis.
  SphereScan by_axis = nullptr;
};

// Of a supported target.
SphereScans SphereScansFor(Target target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_SPHERE_SCAN_H_
