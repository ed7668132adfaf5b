// Baselines: the loops that one would write instead of calling the library.
// They are part of cpuinfo-bench only.
#ifndef HALFSPACE_BENCH_BASELINES_BASELINES_H_
#define HALFSPACE_BENCH_BASELINES_BASELINES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "bench/baselines/simplex_job.h"
#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::bench {

// Octahedra as an array of structures, in halves of 16 bytes: all up simplices,
// then all down simplices, so that an object that the first rejects costs 16
// bytes.
struct HalvesWorld {
  struct Half {
    float x, y, z, d;
  };
  std::vector<Half> up;    // minima
  std::vector<Half> down;  // maxima
};

HalvesWorld MakeHalves(const AaboView3& view);

// Counts the survivors of each query, object by object, with an early-out after
// every compare; a tile of objects that stays in the cache for all queries.
void CountScalar(const HalvesWorld& world, std::span<const Aabo3> queries,
                 std::span<std::size_t> counts);

// Counts the survivors, by tiles of objects as above, in a loop that the
// compiler vectorises.
using CountSimplices = void (*)(const SimplexJob& job);

// The two ways to write the loop.
struct VectorisedForm {
  const char* name;
  CountSimplices count;
};
using VectorisedForms = std::array<VectorisedForm, 2>;

// Compiled for the instructions of a target, by Highway's name: SSE4, AVX2, or
// any that begins with AVX3; for all others, for the baseline.
VectorisedForms VectorisedFormsFor(std::string_view target);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BASELINES_H_
