// The factories of what was not found when this was built.

#include "bench/baselines/body_space.h"
#include "bench/baselines/box_tree.h"

namespace halfspace::bench {

#ifdef HALFSPACE_BENCH_NO_BOOST
std::unique_ptr<BoxTree<2>> MakeBoostTree(std::span<const Aabb2> /*boxes*/,
                                          std::size_t /*node_size*/) {
  return nullptr;
}
std::unique_ptr<BoxTree<3>> MakeBoostTree(std::span<const Aabb3> /*boxes*/,
                                          std::size_t /*node_size*/) {
  return nullptr;
}
std::unique_ptr<NearestTree<2>> MakeBoostNearest(
    std::span<const Aabb2> /*boxes*/, std::size_t /*node_size*/) {
  return nullptr;
}
std::unique_ptr<NearestTree<3>> MakeBoostNearest(
    std::span<const Aabb3> /*boxes*/, std::size_t /*node_size*/) {
  return nullptr;
}
#endif

#ifdef HALFSPACE_BENCH_NO_BULLET
std::unique_ptr<BoxTree<3>> MakeBulletTree(std::span<const Aabb3> /*boxes*/) {
  return nullptr;
}
BodySpacePtr<3> MakeBulletSpace(std::size_t /*bodies*/) { return nullptr; }
#endif

#ifdef HALFSPACE_BENCH_NO_BOX2D
BodySpacePtr<2> MakeBox2dSpace(std::size_t /*bodies*/) { return nullptr; }
#endif

#ifdef HALFSPACE_BENCH_NO_FCL
BodySpacePtr<3> MakeFclSpace(std::size_t /*bodies*/) { return nullptr; }
#endif

#ifdef HALFSPACE_BENCH_NO_CGAL
std::unique_ptr<PairFinder> MakeCgalPairs(std::span<const Aabb3> /*boxes*/,
                                          std::ptrdiff_t /*cutoff*/) {
  return nullptr;
}
#endif

#ifdef HALFSPACE_BENCH_NO_EMBREE
std::unique_ptr<BoxTree<3>> MakeEmbreeTree(std::span<const Aabb3> /*boxes*/) {
  return nullptr;
}
std::unique_ptr<LineTree> MakeEmbreeLines(std::span<const Aabb3> /*boxes*/) {
  return nullptr;
}
std::unique_ptr<PairFinder> MakeEmbreePairs(std::span<const Aabb3> /*boxes*/) {
  return nullptr;
}
#endif

#ifdef HALFSPACE_BENCH_NO_GEOS
std::unique_ptr<BoxTree<2>> MakeGeosTree(std::span<const Aabb2> /*boxes*/) {
  return nullptr;
}
#endif

#ifdef HALFSPACE_BENCH_NO_NANOFLANN
std::unique_ptr<NearestTree<2>> MakeNanoflann(
    std::span<const Point<2>> /*points*/) {
  return nullptr;
}
std::unique_ptr<NearestTree<3>> MakeNanoflann(
    std::span<const Point<3>> /*points*/) {
  return nullptr;
}
#endif

}  // namespace halfspace::bench
