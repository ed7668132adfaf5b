// The half-spaces of a camera, from its view-projection matrix.
//
//   const halfspace::Frustum3 seen = halfspace::FrustumPlanes(
//       &view_projection[0][0], halfspace::ClipDepth::kZeroToOne);
//   halfspace::SurvivorMask(world, seen, mask);      // reject_shapes.h
//   halfspace::Survivors(bvh, seen, ids);            // bvh_shapes.h
//
// Include reject_shapes.h or bvh_shapes.h for the queries. examples/culling.cc
// is a whole program.
#ifndef HALFSPACE_FRUSTUM_H_
#define HALFSPACE_FRUSTUM_H_

#include <array>
#include <cstdint>

#include "halfspace/export.h"
#include "halfspace/shapes.h"

namespace halfspace {

// Where clip space begins: -w <= z <= w, as in OpenGL, or 0 <= z <= w, as in
// Direct3D, Vulkan, Metal and WebGPU. Which end is near does not matter: a
// reversed depth has the same half-spaces.
enum class ClipDepth : std::uint8_t { kMinusOneToOne, kZeroToOne };

// How a matrix M that makes clip coordinates M * (x, y, z, 1) is stored. By
// columns: OpenGL, GLM, Vulkan. A matrix for row vectors, (x, y, z, 1) * M,
// that is stored by rows has the same 16 numbers: DirectXMath, HLSL's
// row_major. Choose kRowMajor only if vectors are columns and the matrix is
// stored by rows.
enum class MatrixOrder : std::uint8_t { kColumnMajor, kRowMajor };

// The half-spaces of the six sides: left, right, bottom, top, and the two ends
// of the depth. Then those of an axis-aligned box around the frustum, which are
// cheap to test and reject large objects near its corners. For small spheres
// the six sides alone, {seen.data(), 6}, take less time. Normals point inward.
// One that keeps everything has the normal 0 and the offset 0.
using Frustum3 = std::array<HalfSpace3, 12>;

// Returns the half-spaces of what a camera sees: of all points that M takes
// into clip space. `matrix` is the product of projection and view, 16 floats.
// For objects in the space of a model, multiply by its matrix, too.
//
// No point of the frustum of the exact matrix is lost. The half-spaces are
// larger than it by about 2^-23 of the largest coordinate of a corner. Without
// a far plane it is 2^-20 of the distance from the eye. If a plane of the depth
// is nearly parallel to an edge, it is more.
//
// An infinite far plane, or one that cuts only some of the four edges, keeps
// everything, and there is no box. A near plane that only some edges enter
// keeps everything, too: the region then begins at the eye. A matrix with a NaN
// or an infinity, whose sides make no frustum, or whose far plane is before its
// near plane, keeps everything: all normals are 0.
//
// Errors (error.h): the pointer must not be null or misaligned, and the others
// must be enumerators.
//
// Thread safety: reentrant. No allocation. Floating-point mode: as fit.h. Cost:
// about 0.4 us (an EPYC, family 25 model 17). Compute it once a frame.
//
// Source: G. Gribb and K. Hartmann, "Fast Extraction of Viewing Frustum Planes
// from the World-View-Projection Matrix", 2001.
HALFSPACE_API Frustum3
FrustumPlanes(const float* matrix, ClipDepth depth,
              MatrixOrder order = MatrixOrder::kColumnMajor);

}  // namespace halfspace

#endif  // HALFSPACE_FRUSTUM_H_
