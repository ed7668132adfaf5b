// Reads the triangles of a Wavefront OBJ file.
//
// Only `v` and `f` are read, and strictly: what cannot be understood is an
// error, never a guess, because one vertex that is dropped or read as zero
// moves every triangle after it. The other statements of the format are
// skipped; no other file is ever opened.
//
//   v x y z [w | r g b]         w and the colour are checked, then ignored
//   f corner corner corner ...  a corner is v, v/vt, v//vn or v/vt/vn; v counts
//                               from 1, or back from -1, the last vertex so far
//
// Polygons are fanned: corners (0, i, i + 1). A face may name vertices that
// come after it. Lines may end in LF or CR LF; a backslash at the end of a
// line that is no comment continues it; # starts a comment.
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

// The most that a mesh may have; by default, what 32 bits can count.
struct MeshLimits {
  std::uint32_t vertices = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t triangles = std::numeric_limits<std::uint32_t>::max();
};

// At least one triangle; all coordinates finite, all indices below vertices().
// Throws InputError. Takes memory in proportion to the size of the file,
// whatever the numbers in it say.
Mesh ReadMesh(const std::string& path, const MeshLimits& limits = {});

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_MESH_READER_H_
