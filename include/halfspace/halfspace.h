// halfspace answers one question: which of these stored bounds could this query
// touch?
//
// This header includes every public header, except error.h, which needs
// <stdexcept> and with it a third more lines. Each header documents its own
// calls:
//   bounds.h       bounding volumes (k-DOPs)
//   shapes.h       points, boxes, spheres, ...: the input of builders
//   fit.h          builders: compute a bound that encloses a shape
//   transform.h    compute a bound from bounds: merge, inflate, move, sweep
//   fit_many.h     builders of many bounds at once, in SIMD
//   frustum.h      half-spaces from a camera's matrix
//   fit_status.h   counts the shapes that a builder could not bound
//   planes.h       the output arrays of fit_many.h
//   span.h         the type of all array parameters
//   visit.h        what callbacks return
//   world.h        stored bounds: views and owning worlds
//   quantized.h    stored bounds with one or two bytes per plane
//   memory.h       where owning worlds allocate their memory
//   mask.h         the bits of a mask
//   kernels.h      the tests alone: no checks, options or worlds
//   reject.h       tests one query: masks, index lists, counts
//   reject_many.h  tests several queries
//   reject_shapes.h  tests half-spaces, for example a frustum, and spheres
//   bvh.h          a hierarchy (BVH) for large worlds
//   runner.h       the caller's threads, for builds and refits of a BVH
//   bvh_shapes.h   BVH queries by points, spheres, oriented boxes and others
//   bvh_nearest.h  k nearest, ray casts and box casts on a BVH
//   mesh.h         rays and closest points on triangles that do not move
//   triangles.h    the same of one triangle
//   bvh_pairs.h    all overlapping pairs of such worlds
//   pair_events.h  which of these pairs began and ended since the last frame
//   broad_phase.h  moving bodies: queries and pairs beside changes
//   target.h       the instruction set of one call
//   targets.h      all instruction sets
//   error.h        how calls report a violated precondition
//   version.h      the library's version
//
// The pages of docs/ that headers name are installed with the headers, in
// share/doc/halfspace.
#ifndef HALFSPACE_HALFSPACE_H_
#define HALFSPACE_HALFSPACE_H_

#include "halfspace/bounds.h"         // IWYU pragma: export
#include "halfspace/broad_phase.h"    // IWYU pragma: export
#include "halfspace/bvh.h"            // IWYU pragma: export
#include "halfspace/bvh_nearest.h"    // IWYU pragma: export
#include "halfspace/bvh_pairs.h"      // IWYU pragma: export
#include "halfspace/bvh_shapes.h"     // IWYU pragma: export
#include "halfspace/fit.h"            // IWYU pragma: export
#include "halfspace/fit_many.h"       // IWYU pragma: export
#include "halfspace/fit_status.h"     // IWYU pragma: export
#include "halfspace/frustum.h"        // IWYU pragma: export
#include "halfspace/kernels.h"        // IWYU pragma: export
#include "halfspace/mask.h"           // IWYU pragma: export
#include "halfspace/memory.h"         // IWYU pragma: export
#include "halfspace/mesh.h"           // IWYU pragma: export
#include "halfspace/pair_events.h"    // IWYU pragma: export
#include "halfspace/planes.h"         // IWYU pragma: export
#include "halfspace/quantized.h"      // IWYU pragma: export
#include "halfspace/reject.h"         // IWYU pragma: export
#include "halfspace/reject_many.h"    // IWYU pragma: export
#include "halfspace/reject_shapes.h"  // IWYU pragma: export
#include "halfspace/runner.h"         // IWYU pragma: export
#include "halfspace/shapes.h"         // IWYU pragma: export
#include "halfspace/span.h"           // IWYU pragma: export
#include "halfspace/target.h"         // IWYU pragma: export
#include "halfspace/targets.h"        // IWYU pragma: export
#include "halfspace/transform.h"      // IWYU pragma: export
#include "halfspace/triangles.h"      // IWYU pragma: export
#include "halfspace/version.h"        // IWYU pragma: export
#include "halfspace/visit.h"          // IWYU pragma: export
#include "halfspace/world.h"          // IWYU pragma: export

#endif  // HALFSPACE_HALFSPACE_H_
