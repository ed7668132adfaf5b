// Boxes and the boxes to query them with: what trees are measured on.
#ifndef HALFSPACE_BENCH_WORLDS_BOX_SET_H_
#define HALFSPACE_BENCH_WORLDS_BOX_SET_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/worlds/workload.h"
#include "halfspace/bounds.h"

namespace halfspace::bench {

template <int kDims>
struct BoxSet {
  std::string name;
  std::vector<Aabb<kDims>> boxes;
  std::vector<Aabb<kDims>> queries;  // kTimedQueries
};

// Boxes of that side with centers uniform in [-50, 50]^kDims, and queries of
// the same kind. The same seed gives the same boxes on every machine.
template <int kDims>
BoxSet<kDims> MakeUniformBoxes(const std::string& name, std::size_t count,
                               float side, std::uint64_t seed);

// Worlds of boxes in 3D, and queries of the same kind, without the few that
// skew a world. The first one has 50 clusters: how many boxes a cluster has,
// and how long a box is, are log-normal. In the others a query finds about as
// many boxes as in the uniform world of boxes of side `side`.
struct SkewedWorld {
  const char* name;
  BoxSet<3> (*make)(std::size_t count, float side, std::uint64_t seed);
};
std::span<const SkewedWorld> SkewedWorlds();

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_BOX_SET_H_
