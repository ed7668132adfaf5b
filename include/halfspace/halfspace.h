// halfspace: which of these stored bounds could this query touch?
//
// Includes every public header. Each is the manual of its calls:
//   bounds.h   the bounding volumes
//   fit.h      from points and boxes to bounds that surely enclose them
//   world.h    many stored bounds: views and owning arrays
//   reject.h   the tests: masks, index lists, counts
//   targets.h  the instruction sets
#ifndef HALFSPACE_HALFSPACE_H_
#define HALFSPACE_HALFSPACE_H_

#include "halfspace/bounds.h"   // IWYU pragma: export
#include "halfspace/fit.h"      // IWYU pragma: export
#include "halfspace/reject.h"   // IWYU pragma: export
#include "halfspace/targets.h"  // IWYU pragma: export
#include "halfspace/version.h"  // IWYU pragma: export
#include "halfspace/world.h"    // IWYU pragma: export

#endif  // HALFSPACE_HALFSPACE_H_
