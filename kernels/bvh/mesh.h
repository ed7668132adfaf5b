// A triangle mesh as its kernels read it: a BVH of 16-wide nodes, whose leaves
// are groups of up to 16 triangles. No Highway here.
#ifndef HALFSPACE_KERNELS_BVH_MESH_H_
#define HALFSPACE_KERNELS_BVH_MESH_H_

#include <cstddef>
#include <cstdint>

#include "kernels/bvh/kernel_table.h"
#include "kernels/bvh/shape_query.h"

namespace halfspace::detail {

inline constexpr std::size_t kMeshLanes = 16;

// The name of a node or a group: its index, above that the number of its
// children or triangles less 1, and in the highest bit whether it is a group.
using MeshRef = std::uint32_t;
inline constexpr std::uint32_t kMeshIndexBits = 27;
inline constexpr std::uint32_t kMeshGroupBit = std::uint32_t{1} << 31;
constexpr std::size_t MeshIndexOf(MeshRef ref) {
  return ref & ((std::uint32_t{1} << kMeshIndexBits) - 1);
}
constexpr std::uint64_t MeshLanesOf(MeshRef ref) {
  return (std::uint64_t{2} << (ref >> kMeshIndexBits & (kMeshLanes - 1))) - 1;
}

// A cube around all corners of a group or a mesh.
struct MeshCube {
  float center[3];
  float half;  // of a side
};

struct alignas(64) MeshNode {
  float planes[6][kMeshLanes];  // the boxes of children: minima, then maxima
  MeshRef child[kMeshLanes];
};

struct alignas(64) MeshGroup {
  float corners[9][kMeshLanes];  // x y z of a, of b and of c
  std::uint32_t id[kMeshLanes];
  MeshCube cube;
  // The bits of the lanes whose triangle is a point. No ray hits it, and the
  // filter of rays cannot reject it, so it would be tested exactly.
  std::uint32_t are_points;
};

struct MeshTree {
  const MeshNode* nodes;
  const MeshGroup* groups;
  MeshRef root;
  MeshCube cube;
};

// The least depth at which each node has equal shares of triangles for
// children, so that 7 levels more have 2^27 of them. An entry waits for each
// child but one of the nodes on the way.
inline constexpr std::size_t kMeshDepth = 16;
inline constexpr std::size_t kMeshWaiting = (kMeshDepth + 7) * (kMeshLanes - 1);

// Tests a triangle exactly. Returns a new limit, which is that of the search if
// it is less. A negative one ends the search.
using MeshFunction = float (*)(void* context, const MeshGroup& group,
                               std::size_t lane);

// A ray, whose numbers are finite. Axis 2 is the one on which it moves most.
struct MeshCast {
  const MeshTree* tree;
  Line line;  // for boxes, up to its max_t, which is finite
  float origin[3];
  std::size_t axis[3];
  float shear[2];  // the direction on axes 0 and 1 over that on axis 2
  float speed;     // on axis 2
  MeshFunction function;
  void* context;
};

// A point, whose numbers are finite.
struct MeshNearest {
  const MeshTree* tree;
  float point[3];
  float limit;  // of distances
  MeshFunction function;
  void* context;
};

struct MeshKernels {
  void (*cast)(const MeshCast& cast);
  void (*nearest)(const MeshNearest& search);
};

extern template struct KernelsOfAll<MeshKernels>;

}  // namespace halfspace::detail

#endif  // HALFSPACE_KERNELS_BVH_MESH_H_
