#include "kernels/reference.h"

namespace halfspace::reference {

bool Rejects(const SimplexView2& world, const DownSimplex2& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  return false;
}

bool Rejects(const SimplexView3& world, const DownSimplex3& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  return false;
}

bool Rejects(const SimplexView4& world, const DownSimplex4& query,
             std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.min[3][i] > query.max[3]) return true;
  if (world.min[4][i] > query.max[4]) return true;
  return false;
}

bool Rejects(const AabbView2& world, const Aabb2& query, std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  return false;
}

bool Rejects(const AabbView3& world, const Aabb3& query, std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  return false;
}

bool Rejects(const AabbView4& world, const Aabb4& query, std::size_t i) {
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

bool Rejects(const AaboView2& world, const Aabo2& query, std::size_t i) {
  if (world.min[0][i] > query.max[0]) return true;
  if (world.min[1][i] > query.max[1]) return true;
  if (world.min[2][i] > query.max[2]) return true;
  if (world.max[0][i] < query.min[0]) return true;
  if (world.max[1][i] < query.min[1]) return true;
  if (world.max[2][i] < query.min[2]) return true;
  return false;
}

bool Rejects(const AaboView3& world, const Aabo3& query, std::size_t i) {
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

bool Rejects(const AaboView4& world, const Aabo4& query, std::size_t i) {
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

template void RejectMask(const SimplexView2&, const DownSimplex2&,
                         std::uint64_t*);
template void RejectMask(const SimplexView3&, const DownSimplex3&,
                         std::uint64_t*);
template void RejectMask(const SimplexView4&, const DownSimplex4&,
                         std::uint64_t*);
template void RejectMask(const AabbView2&, const Aabb2&, std::uint64_t*);
template void RejectMask(const AabbView3&, const Aabb3&, std::uint64_t*);
template void RejectMask(const AabbView4&, const Aabb4&, std::uint64_t*);
template void RejectMask(const AaboView2&, const Aabo2&, std::uint64_t*);
template void RejectMask(const AaboView3&, const Aabo3&, std::uint64_t*);
template void RejectMask(const AaboView4&, const Aabo4&, std::uint64_t*);

}  // namespace halfspace::reference
