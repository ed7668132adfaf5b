// halfspace: which of these stored bounds could this query touch?
//
// Includes every public header. Each is the manual of its calls:
//   bounds.h   the bounding volumes
//   shapes.h   points, boxes, spheres, ...: what callers have
//   fit.h      bounds that surely enclose a shape
//   transform.h  bounds of bounds: merged, inflated, moved, swept
//   fit_many.h bounds of many shapes at once, in SIMD
//   span.h     how calls take lists and outputs
//   world.h    many stored bounds: views and owning arrays
//   quantized.h    worlds of one or two bytes a plane
//   reject.h   the tests: masks, index lists, counts
//   reject_many.h  many queries at once
//   targets.h  the instruction sets
//   error.h    what a violated precondition does
#ifndef HALFSPACE_HALFSPACE_H_
#define HALFSPACE_HALFSPACE_H_

#include "halfspace/bounds.h"       // IWYU pragma: export
#include "halfspace/error.h"        // IWYU pragma: export
#include "halfspace/fit.h"          // IWYU pragma: export
#include "halfspace/fit_many.h"     // IWYU pragma: export
#include "halfspace/fit_status.h"   // IWYU pragma: export
#include "halfspace/planes.h"       // IWYU pragma: export
#include "halfspace/quantized.h"    // IWYU pragma: export
#include "halfspace/reject.h"       // IWYU pragma: export
#include "halfspace/reject_many.h"  // IWYU pragma: export
#include "halfspace/shapes.h"       // IWYU pragma: export
#include "halfspace/span.h"         // IWYU pragma: export
#include "halfspace/targets.h"      // IWYU pragma: export
#include "halfspace/transform.h"    // IWYU pragma: export
#include "halfspace/version.h"      // IWYU pragma: export
#include "halfspace/world.h"        // IWYU pragma: export

#endif  // HALFSPACE_HALFSPACE_H_
