// What is measured: stored bounds and the queries against them. Octahedra, so
// that one copy serves as all three shapes.
#ifndef HALFSPACE_BENCH_WORLDS_WORKLOAD_H_
#define HALFSPACE_BENCH_WORLDS_WORKLOAD_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/baselines/triangles.h"
#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::bench {

// So many queries that no branch predictor learns their results, and that the
// first-level cache does not keep their paths through a tree. With 128 in turn
// a tree takes a half to a fifth of the time.
inline constexpr std::size_t kTimedQueries = 20000;

struct Workload {
  std::string name;  // "scene", or the file it was read from
  AaboWorld3 objects;
  std::vector<Aabo3> queries;  // to count with

  // To time one after the other.
  std::vector<Aabo3> timed_queries = {};
};

// A world of exactly `objects` objects: those of the workload, again and again
// if it has fewer.
AaboWorld3 ResizedTo(const AaboWorld3& source, std::size_t objects);

// At most so many objects, spread evenly: neighbours in a file are neighbours
// in space.
AaboWorld3 Thinned(const AaboWorld3& source, std::size_t most);

// The box around all objects that can be bounded; around none of them, a point.
Aabb3 BoxAround(const AaboWorld3& objects);

// Queries with the bounds of `source`: to count with every (size / 256)-th one,
// to time every (size / kTimedQueries)-th one, in random order. `queries` other
// than 0 is taken for 256; those to time are then the same.
void QueryWith(Workload& workload, const AaboWorld3& source,
               std::size_t queries);

// kTimedQueries boxes, or `queries` if that is not 0, uniform within the box
// around all objects. Their sides are `percent` of its.
AaboWorld3 RandomBoxes(const Workload& workload, double percent,
                       std::size_t queries, std::uint64_t seed);

// A mesh as a workload: one bound per triangle (3 indices each into xyz
// triples), which are also what is queried with.
Workload WorkloadOfTriangles(std::string name,
                             const std::vector<float>& coordinates,
                             const std::vector<std::uint32_t>& indices,
                             std::size_t queries);

// The workload with each bound, of objects and of timed queries, replaced by
// the octahedron around its box: content that is known as boxes only.
Workload BoxesOf(const Workload& workload);

// Boxes as a workload, and as what is queried with.
Workload WorkloadOfBoxes(std::string name, const std::vector<Aabb3>& boxes,
                         std::size_t queries);

// The paper's scene: objects are point clouds in a cube, queries are drawn from
// the same distribution.

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

// Pairs of triangles around each other, as candidates of an exact test are.
std::vector<std::array<Triangle, 2>> TrianglePairs(std::size_t count,
                                                   std::uint64_t seed);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_WORKLOAD_H_
