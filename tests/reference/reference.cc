#include "tests/reference/reference.h"

namespace halfspace::reference {
namespace {

// True iff object `i` is provably separated from the query. Stops at the first
// plane that shows it.
template <int kDims>
bool Rejects(const SimplexView<kDims>& world, const DownSimplex<kDims>& query,
             std::size_t i) {
  for (std::size_t k = 0; k <= kDims; ++k) {
    if (world.min[k][i] > query.max[k]) return true;
  }
  return false;
}

template <int kDims, typename T>
bool Rejects(const AabbView<kDims, T>& world, const Aabb<kDims, T>& query,
             std::size_t i) {
  for (std::size_t k = 0; k < kDims; ++k) {
    if (world.min[k][i] > query.max[k]) return true;
    if (world.max[k][i] < query.min[k]) return true;
  }
  return false;
}

template <int kDims>
bool Rejects(const AaboView<kDims>& world, const Aabo<kDims>& query,
             std::size_t i) {
  for (std::size_t k = 0; k <= kDims; ++k) {
    if (world.min[k][i] > query.max[k]) return true;
  }
  for (std::size_t k = 0; k <= kDims; ++k) {
    if (world.max[k][i] < query.min[k]) return true;
  }
  return false;
}

}  // namespace

template <typename View>
void RejectMask(const View& world, const typename View::Query& query,
                std::uint64_t* mask) {
  for (std::size_t begin = 0; begin < world.size; begin += 64) {
    std::uint64_t word = 0;
    for (std::size_t bit = 0; bit < 64; ++bit) {
      const std::size_t i = begin + bit;
      if (i >= world.size || Rejects(world, query, i)) {
        word |= std::uint64_t{1} << bit;
      }
    }
    mask[begin / 64] = word;
  }
}

// Every shape, in every number of dimensions.
#define HALFSPACE_INSTANTIATE(kDims)                                   \
  template void RejectMask(const SimplexView<kDims>&,                  \
                           const DownSimplex<kDims>&, std::uint64_t*); \
  template void RejectMask(const AabbView<kDims>&, const Aabb<kDims>&, \
                           std::uint64_t*);                            \
  template void RejectMask(const AaboView<kDims>&, const Aabo<kDims>&, \
                           std::uint64_t*);                            \
  template void RejectMask(const AabbView<kDims, double>&,             \
                           const Aabb<kDims, double>&, std::uint64_t*)

HALFSPACE_INSTANTIATE(2);
HALFSPACE_INSTANTIATE(3);
HALFSPACE_INSTANTIATE(4);

#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace::reference
