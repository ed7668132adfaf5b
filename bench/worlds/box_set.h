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
BoxSet<kDims> MakeUniformBoxes(std::string name, std::size_t count, float side,
                               std::uint64_t seed);

// Boxes in 50 clusters, and queries of the same kind: how many boxes a cluster
// has, and how long a box is, are log-normal; centers are spread around those
// of the clusters, which are uniform in [-50, 50]^3.
BoxSet<3> MakeClusters(std::string name, std::size_t count, std::uint64_t seed);

// A uniform world with a skew. Queries are of the same kind as the boxes,
// without the few that skew the world. A query finds about as many boxes as in
// the uniform world of boxes of side `side`.
struct SkewedWorld {
  const char* name;
  BoxSet<3> (*make)(std::string name, std::size_t count, float side,
                    std::uint64_t seed);
};
std::span<const SkewedWorld> SkewedWorlds();

// The boxes of a workload, and those of its queries to time; these again and
// again if they are fewer than kTimedQueries.
BoxSet<3> BoxesOf(std::string name, const Workload& workload);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_BOX_SET_H_
