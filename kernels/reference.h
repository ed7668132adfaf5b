// The oracle: every shape's inequality written out by hand, one object at a
// time, as in the paper. It shares nothing with the kernels, so that an error
// in their plane tables cannot hide, and it is compiled without
// auto-vectorisation, so that "scalar" stays scalar when it is timed.
//
// Planes are in the order of the views: all minima, then all maxima.
#ifndef HALFSPACE_KERNELS_REFERENCE_H_
#define HALFSPACE_KERNELS_REFERENCE_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::reference {

// True iff object `i` is provably separated from the query. Stops at the first
// plane that shows it.
bool Rejects(const SimplexView2& world, const DownSimplex2& query,
             std::size_t i);
bool Rejects(const SimplexView3& world, const DownSimplex3& query,
             std::size_t i);
bool Rejects(const SimplexView4& world, const DownSimplex4& query,
             std::size_t i);
bool Rejects(const AabbView2& world, const Aabb2& query, std::size_t i);
bool Rejects(const AabbView3& world, const Aabb3& query, std::size_t i);
bool Rejects(const AabbView4& world, const Aabb4& query, std::size_t i);
bool Rejects(const AaboView2& world, const Aabo2& query, std::size_t i);
bool Rejects(const AaboView3& world, const Aabo3& query, std::size_t i);
bool Rejects(const AaboView4& world, const Aabo4& query, std::size_t i);

// The reject mask of the whole world, one object after the other; defined for
// every pair above. The scalar rival that benchmarks time.
template <typename View>
void RejectMask(const View& world, const typename View::Query& query,
                std::uint64_t* mask);

}  // namespace halfspace::reference

#endif  // HALFSPACE_KERNELS_REFERENCE_H_
