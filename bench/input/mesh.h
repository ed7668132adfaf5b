// Triangles that were read from a file.
#ifndef HALFSPACE_BENCH_INPUT_MESH_H_
#define HALFSPACE_BENCH_INPUT_MESH_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace halfspace::bench {

struct Mesh {
  std::vector<float> coords;           // vertex i: x, y, z from 3 * i on
  std::vector<std::uint32_t> indices;  // triangle t: 3 vertices from 3 * t on

  std::size_t vertices() const { return coords.size() / 3; }
  std::size_t triangles() const { return indices.size() / 3; }
};

// The most that a mesh may have; by default, what 32 bits can count.
struct MeshLimits {
  std::uint32_t vertices = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t triangles = std::numeric_limits<std::uint32_t>::max();
  // Of all buffers that a glTF has in files of their own.
  std::size_t buffer_bytes = std::numeric_limits<std::size_t>::max();
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_MESH_H_
