// What is measured: stored bounds and the queries against them. Octahedra, so
// that one copy serves as all three shapes.
#ifndef HALFSPACE_BENCH_WORKLOAD_H_
#define HALFSPACE_BENCH_WORKLOAD_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::bench {

struct Workload {
  std::string name;  // "scene", or the file it was read from
  AaboWorld3 objects;
  std::vector<Aabo3> queries;
};

// A world of exactly `objects` objects: those of the workload, again and again
// if it has fewer.
AaboWorld3 ResizedTo(const AaboWorld3& source, std::size_t objects);

// A mesh as a workload: one bound per triangle (3 indices each into xyz
// triples), and a query of every (triangles / 256)-th one. `queries` other than
// 0 changes 256.
Workload WorkloadOfTriangles(std::string name,
                             const std::vector<float>& coordinates,
                             const std::vector<std::uint32_t>& indices,
                             std::size_t queries);

// Boxes as a workload, with queries by the same rule.
Workload WorkloadOfBoxes(std::string name, const std::vector<Aabb3>& boxes,
                         std::size_t queries);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORKLOAD_H_
