// What survives the codes is tested on the floats.
#ifndef HALFSPACE_DISPATCH_CONFIRM_H_
#define HALFSPACE_DISPATCH_CONFIRM_H_

#include <cstddef>

#include "halfspace/detail/scan.h"

namespace halfspace::dispatch {

// Asks for the floats of an object, so that they are there a little later.
void PrefetchFloats(const detail::Scan& scan, std::size_t object);

// Whether a plane of floats rejects it.
bool FloatsReject(const detail::Scan& scan, const float* query,
                  std::size_t object);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_CONFIRM_H_
