// Competitors: what other libraries offer for boxes, and two plain loops, which
// a user might take instead. One question at a time, in one thread.
//
// Boxes are closed: those that touch count. Boxes and queries are finite, and
// no minimum is above its maximum. A competitor copies the boxes when it is
// made, and does then whatever it can do before it is asked. The factory of a
// library that was not installed when this was built returns nullptr.
//
// What is found replaces what the vector held. Nothing is allocated for it if
// it fits what the caller reserved.
#ifndef HALFSPACE_BENCH_BASELINES_BOX_TREE_H_
#define HALFSPACE_BENCH_BASELINES_BOX_TREE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "halfspace/bounds.h"
#include "halfspace/shapes.h"

namespace halfspace::bench {

class Competitor {
 public:
  Competitor() = default;
  Competitor(const Competitor&) = delete;
  Competitor& operator=(const Competitor&) = delete;
  virtual ~Competitor() = default;
};

template <int kDims>
class BoxTree : public Competitor {
 public:
  // The indices of the boxes that touch the query, in any order.
  virtual void Find(const Aabb<kDims>& query,
                    std::vector<std::uint32_t>& found) const = 0;
  // How many these are. A library that can count need not list them.
  virtual std::size_t Count(const Aabb<kDims>& query) const {
    std::vector<std::uint32_t> found;
    Find(query, found);
    return found.size();
  }
};

template <int kDims>
class NearestTree : public Competitor {
 public:
  // The indices of the `count` boxes, or all if these are fewer, that are
  // nearest to the point, in any order. 0 is the distance of a box from a point
  // in it.
  virtual void Nearest(const Point<kDims>& point, std::size_t count,
                       std::vector<std::uint32_t>& found) = 0;
};

class LineTree : public Competitor {
 public:
  // The indices of the boxes that the segment touches, in any order.
  virtual void Along(const Segment<3>& segment,
                     std::vector<std::uint32_t>& found) const = 0;
};

using IndexPair = std::array<std::uint32_t, 2>;

class PairFinder : public Competitor {
 public:
  // Which boxes touch one another: each pair once, in any order, as are the two
  // of a pair.
  virtual void Pairs(std::vector<IndexPair>& found) = 0;
};

// Boost.Geometry's R-tree, quadratic<node_size>, packed from all boxes at once.
// The size is 8, 16 or 32.
std::unique_ptr<BoxTree<2>> MakeBoostTree(std::span<const Aabb2> boxes,
                                          std::size_t node_size = 16);
std::unique_ptr<BoxTree<3>> MakeBoostTree(std::span<const Aabb3> boxes,
                                          std::size_t node_size = 16);
std::unique_ptr<NearestTree<2>> MakeBoostNearest(std::span<const Aabb2> boxes,
                                                 std::size_t node_size = 16);
std::unique_ptr<NearestTree<3>> MakeBoostNearest(std::span<const Aabb3> boxes,
                                                 std::size_t node_size = 16);

// Bullet's btDbvt, built by insertion and then optimised from the top down.
// Coordinates are at most 1e12: where the volume of a box is no float, it
// writes beyond its arrays.
std::unique_ptr<BoxTree<3>> MakeBulletTree(std::span<const Aabb3> boxes);

// Embree's tree of user geometry. Its query is a sphere, here that around the
// box. The ends of a segment are at most twice as far from 0, on each axis, as
// the farthest corner of a box.
std::unique_ptr<BoxTree<3>> MakeEmbreeTree(std::span<const Aabb3> boxes);
std::unique_ptr<LineTree> MakeEmbreeLines(std::span<const Aabb3> boxes);
std::unique_ptr<PairFinder> MakeEmbreePairs(std::span<const Aabb3> boxes);

// GEOS's TemplateSTRtree, of doubles.
std::unique_ptr<BoxTree<2>> MakeGeosTree(std::span<const Aabb2> boxes);

// nanoflann's k-d tree, which knows points only.
std::unique_ptr<NearestTree<2>> MakeNanoflann(std::span<const Point<2>> points);
std::unique_ptr<NearestTree<3>> MakeNanoflann(std::span<const Point<3>> points);

// CGAL's box_self_intersection_d, which does all its work in Pairs(): of so
// many boxes it no longer makes trees, but scans.
std::unique_ptr<PairFinder> MakeCgalPairs(std::span<const Aabb3> boxes,
                                          std::ptrdiff_t cutoff = 10);

// Boxes sorted by their minima on one axis; each is compared with those that
// begin before it ends, in a loop that the compiler vectorises.
std::unique_ptr<PairFinder> MakeSweep(std::span<const Aabb3> boxes);

// A uniform grid: a cell is twice as long as the mean box, or longer where
// cells, or the boxes in them, would be too many.
std::unique_ptr<BoxTree<2>> MakeGrid(std::span<const Aabb2> boxes);
std::unique_ptr<BoxTree<3>> MakeGrid(std::span<const Aabb3> boxes);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BOX_TREE_H_
