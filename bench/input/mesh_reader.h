// Reads the triangles of a mesh: a Wavefront OBJ, or a glTF 2.0 as JSON or as
// GLB. The content tells which, not the file's name.
#ifndef HALFSPACE_BENCH_INPUT_MESH_READER_H_
#define HALFSPACE_BENCH_INPUT_MESH_READER_H_

#include <string>

#include "bench/input/mesh.h"

namespace halfspace::bench {

// At least one triangle; all coordinates finite, all indices below vertices().
// Throws InputError. Takes memory in proportion to the size of the file and to
// the triangles, which are counted before they are taken where a glTF repeats
// them, whatever the other numbers in it say.
Mesh ReadMesh(const std::string& path, const MeshLimits& limits = {});

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_MESH_READER_H_
