// The paper's scene: objects are point clouds in a cube, queries are drawn from
// the same distribution.
#ifndef HALFSPACE_BENCH_WORLDS_SCENE_H_
#define HALFSPACE_BENCH_WORLDS_SCENE_H_

#include <cstddef>
#include <cstdint>

#include "bench/worlds/workload.h"

namespace halfspace::bench {

// The side of the cube that objects are moved within.
inline constexpr float kSceneSide = 100.0f;

// 100 clouds of 50 to 64 points uniform in a sphere of that radius; each object
// and each query is one of them, moved uniformly within [-50, 50]^3. The same
// seed gives the same scene on every machine.
Workload MakeScene(std::size_t objects, std::size_t queries, std::uint64_t seed,
                   float radius = 1.0f);

// A scene whose clouds are that share of the world's side wide. All its queries
// are timed.
Workload SceneOfSize(double share, std::size_t objects, std::uint64_t seed,
                     std::size_t queries = kTimedQueries);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_SCENE_H_
