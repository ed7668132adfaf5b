// Reads the triangles of a Wavefront OBJ file.
//
// Polygons become fans: corners (0, i, i + 1). Only `v` and `f` are read. No
// other file is opened. Other formats are converted first, for example with
// Debian's assimp-utils: `assimp export a.glb a.obj`.
#ifndef HALFSPACE_BENCH_INPUT_MESH_READER_H_
#define HALFSPACE_BENCH_INPUT_MESH_READER_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace halfspace::bench {

struct Mesh {
  std::vector<float> coords;           // vertex i: x, y, z from 3 * i on
  std::vector<std::uint32_t> indices;  // triangle t: 3 vertices from 3 * t on

  std::size_t vertices() const { return coords.size() / 3; }
  std::size_t triangles() const { return indices.size() / 3; }
};

// The most that a mesh may have.
struct MeshLimits {
  std::uint32_t vertices = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t triangles = std::numeric_limits<std::uint32_t>::max();
};

// Returns at least one triangle. All coordinates are finite and all indices are
// below vertices(). Throws InputError. The memory is proportional to the size
// of the file, whatever the numbers in it are.
Mesh ReadMesh(const std::string& path, const MeshLimits& limits = {});

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_MESH_READER_H_
