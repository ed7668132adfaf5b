// halfspace: which of these stored bounds could this query touch?
//
// Includes every public header. Each is the manual of its calls:
//   bounds.h       the bounding volumes (k-DOPs)
//   shapes.h       points, boxes, spheres, ...: the inputs of builders
//   fit.h          builders: a bound that encloses a shape
//   transform.h    bounds of bounds: merged, inflated, moved, swept
//   fit_many.h     builders of many bounds at once, in SIMD
//   fit_status.h   what builders report
//   planes.h       where builders of many bounds write
//   span.h         how calls take lists and outputs
//   world.h        stored bounds: views and owning worlds
//   quantized.h    stored bounds of one or two bytes a plane
//   memory.h       where owning worlds get their memory
//   reject.h       the calls for one query: masks, index lists, counts
//   reject_many.h  the calls for several queries
//   sorted.h       a hierarchy for large worlds
//   sorted_shapes.h   its queries by spheres, segments, capsules, half-spaces
//   sorted_nearest.h  its searches: what is nearest, or first along a ray
//   sorted_pairs.h    all overlapping pairs of such worlds
//   targets.h      the instruction sets
//   error.h        what a violated precondition does
//   version.h      the library's version
#ifndef HALFSPACE_HALFSPACE_H_
#define HALFSPACE_HALFSPACE_H_

#include "halfspace/bounds.h"          // IWYU pragma: export
#include "halfspace/error.h"           // IWYU pragma: export
#include "halfspace/fit.h"             // IWYU pragma: export
#include "halfspace/fit_many.h"        // IWYU pragma: export
#include "halfspace/fit_status.h"      // IWYU pragma: export
#include "halfspace/memory.h"          // IWYU pragma: export
#include "halfspace/planes.h"          // IWYU pragma: export
#include "halfspace/quantized.h"       // IWYU pragma: export
#include "halfspace/reject.h"          // IWYU pragma: export
#include "halfspace/reject_many.h"     // IWYU pragma: export
#include "halfspace/shapes.h"          // IWYU pragma: export
#include "halfspace/sorted.h"          // IWYU pragma: export
#include "halfspace/sorted_nearest.h"  // IWYU pragma: export
#include "halfspace/sorted_pairs.h"    // IWYU pragma: export
#include "halfspace/sorted_shapes.h"   // IWYU pragma: export
#include "halfspace/span.h"            // IWYU pragma: export
#include "halfspace/targets.h"         // IWYU pragma: export
#include "halfspace/transform.h"       // IWYU pragma: export
#include "halfspace/version.h"         // IWYU pragma: export
#include "halfspace/world.h"           // IWYU pragma: export

#endif  // HALFSPACE_HALFSPACE_H_
