// The scene of the public aabo benchmark: so many copies of 100 clouds of 50
// points on a grid.
#ifndef HALFSPACE_BENCH_WORLDS_GRID_SCENE_H_
#define HALFSPACE_BENCH_WORLDS_GRID_SCENE_H_

#include <cstddef>
#include <cstdint>

#include "bench/worlds/workload.h"

namespace halfspace::bench {

// 100 clouds of 50 points, uniform in the unit sphere. Each object is a cloud
// that has been moved to a place in [-50, 50]^3, uniform on a grid of 10 000
// steps per axis; queries likewise.
Workload MakeGridScene(std::size_t objects, std::size_t queries,
                       std::uint64_t seed);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_GRID_SCENE_H_
