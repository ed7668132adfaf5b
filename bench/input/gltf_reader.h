// Reads the triangles of a glTF 2.0 file, as JSON or as GLB.
//
// All meshes of the default scene, else of the first one, are read, moved by
// their nodes in double and once for each node; without a scene, each mesh as
// it is. Triangles, strips and fans are read, and lines and points skipped;
// positions are floats, or integers of 8 and 16 bits (KHR_mesh_quantization).
// Sparse accessors are read. Animations, skins and morph targets are not
// applied, images never opened. What is compressed or would be left out is an
// error, never a guess.
//
// A buffer may be a file in the folder of the glTF or below it, and no other.
#ifndef HALFSPACE_BENCH_INPUT_GLTF_READER_H_
#define HALFSPACE_BENCH_INPUT_GLTF_READER_H_

#include <string>

#include "bench/input/mesh.h"

namespace halfspace::bench {

// What ReadMesh promises, of a file at `path` with this content.
Mesh ReadGltf(const std::string& path, std::string content,
              const MeshLimits& limits);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_GLTF_READER_H_
