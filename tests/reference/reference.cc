#include "tests/reference/reference.h"

namespace halfspace::reference {

bool Rejects(const SimplexView<2>& world, const DownSimplex<2>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  return false;
}

bool Rejects(const SimplexView<3>& world, const DownSimplex<3>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  return false;
}

bool Rejects(const SimplexView<4>& world, const DownSimplex<4>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  if (world.min[4][i] > query.max[4]) return true;
  return false;
}

template <typename T>
bool Rejects(const AabbView<2, T>& world, const Aabb<2, T>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  return false;
}

template <typename T>
bool Rejects(const AabbView<3, T>& world, const Aabb<3, T>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  return false;
}

template <typename T>
bool Rejects(const AabbView<4, T>& world, const Aabb<4, T>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  if (world.max[3][i] < query.min[3]) return true;
  return false;
}

bool Rejects(const AaboView<2>& world, const Aabo<2>& query, std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  return false;
}

bool Rejects(const AaboView<3>& world, const Aabo<3>& query, std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  if (world.max[3][i] < query.min[3]) return true;
  return false;
}

bool Rejects(const AaboView<4>& world, const Aabo<4>& query, std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  if (world.min[4][i] > query.max[4]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  if (world.max[3][i] < query.min[3]) return true;
  if (world.max[4][i] < query.min[4]) return true;
  return false;
}

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
  template bool Rejects(const AabbView<kDims>&, const Aabb<kDims>&,    \
                        std::size_t);                                  \
  template bool Rejects(const AabbView<kDims, double>&,                \
                        const Aabb<kDims, double>&, std::size_t);      \
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
