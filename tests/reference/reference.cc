#include "tests/reference/reference.h"

namespace halfspace::reference {

template <typename T>
bool Rejects(const SimplexView<2, T>& world, const DownSimplex<2, T>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  return false;
}

template <typename T>
bool Rejects(const SimplexView<3, T>& world, const DownSimplex<3, T>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  return false;
}

template <typename T>
bool Rejects(const SimplexView<4, T>& world, const DownSimplex<4, T>& query,
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

template <typename T>
bool Rejects(const AaboView<2, T>& world, const Aabo<2, T>& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  return false;
}

template <typename T>
bool Rejects(const AaboView<3, T>& world, const Aabo<3, T>& query,
             std::size_t i) {
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

template <typename T>
bool Rejects(const AaboView<4, T>& world, const Aabo<4, T>& query,
             std::size_t i) {
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

// Every shape, in every number of dimensions, of floats and of doubles.
#define HALFSPACE_INSTANTIATE(View, Query, kDims, T)                      \
  template bool Rejects(const View<kDims, T>&, const Query<kDims, T>&,    \
                        std::size_t);                                     \
  template void RejectMask(const View<kDims, T>&, const Query<kDims, T>&, \
                           std::uint64_t*)

HALFSPACE_INSTANTIATE(SimplexView, DownSimplex, 2, float);
HALFSPACE_INSTANTIATE(SimplexView, DownSimplex, 3, float);
HALFSPACE_INSTANTIATE(SimplexView, DownSimplex, 4, float);
HALFSPACE_INSTANTIATE(AabbView, Aabb, 2, float);
HALFSPACE_INSTANTIATE(AabbView, Aabb, 3, float);
HALFSPACE_INSTANTIATE(AabbView, Aabb, 4, float);
HALFSPACE_INSTANTIATE(AaboView, Aabo, 2, float);
HALFSPACE_INSTANTIATE(AaboView, Aabo, 3, float);
HALFSPACE_INSTANTIATE(AaboView, Aabo, 4, float);
HALFSPACE_INSTANTIATE(SimplexView, DownSimplex, 2, double);
HALFSPACE_INSTANTIATE(SimplexView, DownSimplex, 3, double);
HALFSPACE_INSTANTIATE(SimplexView, DownSimplex, 4, double);
HALFSPACE_INSTANTIATE(AabbView, Aabb, 2, double);
HALFSPACE_INSTANTIATE(AabbView, Aabb, 3, double);
HALFSPACE_INSTANTIATE(AabbView, Aabb, 4, double);
HALFSPACE_INSTANTIATE(AaboView, Aabo, 2, double);
HALFSPACE_INSTANTIATE(AaboView, Aabo, 3, double);
HALFSPACE_INSTANTIATE(AaboView, Aabo, 4, double);

#undef HALFSPACE_INSTANTIATE

}  // namespace halfspace::reference
