// Loops that test boxes or spheres against the six planes of a frustum, as
// programs have them: what the library's half-spaces are compared with.
#ifndef HALFSPACE_BENCH_BASELINES_CULL_LOOPS_H_
#define HALFSPACE_BENCH_BASELINES_CULL_LOOPS_H_

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "halfspace/shapes.h"

namespace halfspace::bench {

// What a loop reads: minima and maxima of boxes, their centers and half sizes,
// or centers and radii of spheres.
enum class CullInput { kCorners, kCenters, kSpheres };

struct CullLoop {
  const char* name;
  CullInput input;
  bool writes_bytes;  // an object's byte is 1, or else its bit of a word
  // n is a multiple of 64. Normals have the length 1.
  void (*run)(const float* const* planes, std::size_t n,
              const HalfSpace3* frustum, std::uint64_t* kept);
};

// The loops for a target by its name.
std::vector<CullLoop> CullLoopsOf(std::string_view target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_CULL_LOOPS_H_
