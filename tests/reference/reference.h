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

// True iff object `i` is provably separated from the query. Stops at the first
// plane that shows it. T is float or double.
bool Rejects(const SimplexView<2>& world, const DownSimplex<2>& query,
             std::size_t i);
bool Rejects(const SimplexView<3>& world, const DownSimplex<3>& query,
             std::size_t i);
bool Rejects(const SimplexView<4>& world, const DownSimplex<4>& query,
             std::size_t i);
template <typename T>
bool Rejects(const AabbView<2, T>& world, const Aabb<2, T>& query,
             std::size_t i);
template <typename T>
bool Rejects(const AabbView<3, T>& world, const Aabb<3, T>& query,
             std::size_t i);
template <typename T>
bool Rejects(const AabbView<4, T>& world, const Aabb<4, T>& query,
             std::size_t i);
bool Rejects(const AaboView<2>& world, const Aabo<2>& query, std::size_t i);
bool Rejects(const AaboView<3>& world, const Aabo<3>& query, std::size_t i);
bool Rejects(const AaboView<4>& world, const Aabo<4>& query, std::size_t i);

// The reject mask of the whole world, one object after the other; defined for
// every pair above. The scalar baseline that benchmarks time.
template <typename View>
void RejectMask(const View& world, const typename View::Query& query,
                std::uint64_t* mask);

}  // namespace halfspace::reference

#endif  // HALFSPACE_TESTS_REFERENCE_REFERENCE_H_
