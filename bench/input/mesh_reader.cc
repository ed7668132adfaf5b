#include "bench/input/mesh_reader.h"

#include <utility>

#include "bench/input/gltf_document.h"
#include "bench/input/gltf_reader.h"
#include "bench/input/input_file.h"
#include "bench/input/obj_reader.h"

namespace halfspace::bench {

Mesh ReadMesh(const std::string& path, const MeshLimits& limits) {
  std::string content = ReadText(path, kGlbMagic);
  if (IsGltf(content)) return ReadGltf(path, std::move(content), limits);
  return ReadObj(path, std::move(content), limits);
}

}  // namespace halfspace::bench
