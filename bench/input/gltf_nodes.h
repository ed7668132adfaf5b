// Where a glTF's meshes stand in its scene.
#ifndef HALFSPACE_BENCH_INPUT_GLTF_NODES_H_
#define HALFSPACE_BENCH_INPUT_GLTF_NODES_H_

#include <array>
#include <cstddef>
#include <vector>

#include "bench/input/gltf_document.h"

namespace halfspace::bench {

// The rows of [A | b], of p -> A p + b.
using Affine = std::array<std::array<double, 4>, 3>;

struct GltfInstance {
  std::size_t mesh;
  Affine to_scene;
};

// One for each node with a mesh, of the default scene, else of the first one;
// if the file has no scene, one of each mesh as it is. Throws InputError.
std::vector<GltfInstance> MeshInstances(const GltfDocument& document);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_INPUT_GLTF_NODES_H_
