// Objects and queries as the points that they bound, for bounds that cannot be
// made from an octahedron.
#ifndef HALFSPACE_BENCH_WORLDS_POINT_SOURCE_H_
#define HALFSPACE_BENCH_WORLDS_POINT_SOURCE_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "bench/worlds/workload.h"

namespace halfspace::bench {

// Makes one object after the other: the coordinates of its points, at least
// one, point by point. They stay until the next call.
using NextPoints = std::function<std::span<const float>()>;

struct PointSource {
  std::string name;
  std::size_t objects = 0;  // that next_object() may be asked for
  NextPoints next_object;
  NextPoints next_query;
};

// The paper's scene: the objects and queries of MakeScene(objects, ..., seed).
// Queries follow the last object.
PointSource SceneSource(std::size_t objects, std::uint64_t seed);

// The first objects of a file, in its order, `most` at most: the corners of
// triangles or boxes. Queries are random ones of these. The workload must stay.
PointSource FileSource(const Workload& file, std::size_t most,
                       std::uint64_t seed);

// Objects and queries alike, with centers uniform in [-50, 50]^3:
//   balls  50 points uniform in a ball of radius 1, anew for each object
//   boxes  the corners of a box with sides uniform in (0, 3.5), as long in the
//          mean as those around the balls
//   mixed  these two in turn
PointSource BallSource(std::size_t objects, std::uint64_t seed);
PointSource BoxSource(std::size_t objects, std::uint64_t seed);
PointSource MixedSource(std::size_t objects, std::uint64_t seed);

// An octahedron around points, x y z each, at least one, whose axes are
// (1, 1, 1), (1, -1, -1), (-1, 1, -1) and (-1, -1, 1): four normals of a
// regular tetrahedron, which sum to zero. The kernels know planes, and no
// directions.
Aabo3 BoundOnRegularAxes(std::span<const float> points);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_POINT_SOURCE_H_
