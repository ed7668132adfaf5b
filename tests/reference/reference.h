// The oracle: every shape's inequality written out by hand, one object at a
// time, as in the paper. It shares nothing with the kernels, so that an error
// in their plane tables cannot hide, and it is compiled without
// auto-vectorisation, so that "scalar" stays scalar when it is timed.
//
// Planes are in the order of the views: all minima, then all maxima.
#ifndef HALFSPACE_TESTS_REFERENCE_REFERENCE_H_
#define HALFSPACE_TESTS_REFERENCE_REFERENCE_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::reference {

// The reject mask of the whole world, one object after the other. The scalar
// baseline that benchmarks time. Defined for views of floats, and for boxes
// also of doubles, in 2, 3 and 4 dimensions.
template <typename View>
void RejectMask(const View& world, const typename View::Query& query,
                std::uint64_t* mask);

}  // namespace halfspace::reference

#endif  // HALFSPACE_TESTS_REFERENCE_REFERENCE_H_
