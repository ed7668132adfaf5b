#include <boost/geometry/algorithms/distance.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/cartesian/distance_pythagoras_point_box.hpp>
#include <boost/iterator/function_output_iterator.hpp>
#include <utility>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

namespace bg = boost::geometry;
namespace bgi = boost::geometry::index;

template <int kDims>
using BoostPoint = bg::model::point<float, kDims, bg::cs::cartesian>;
template <int kDims>
using BoostBox = bg::model::box<BoostPoint<kDims>>;
template <int kDims>
using Entry = std::pair<BoostBox<kDims>, std::uint32_t>;

BoostPoint<2> BoostPointOf(const Point<2>& p) { return {p[0], p[1]}; }
BoostPoint<3> BoostPointOf(const Point<3>& p) { return {p[0], p[1], p[2]}; }

template <int kDims>
BoostBox<kDims> BoostBoxOf(const Aabb<kDims>& box) {
  return {BoostPointOf(box.min), BoostPointOf(box.max)};
}

auto IndexTaker(std::vector<std::uint32_t>& found) {
  return boost::make_function_output_iterator(
      [&found](const auto& entry) { found.push_back(entry.second); });
}

// Packed from all boxes at once.
template <int kDims, std::size_t kNodeSize>
auto TreeOf(std::span<const Aabb<kDims>> boxes) {
  std::vector<Entry<kDims>> entries;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    entries.emplace_back(BoostBoxOf(boxes[i]), static_cast<std::uint32_t>(i));
  }
  return bgi::rtree<Entry<kDims>, bgi::quadratic<kNodeSize>>(entries);
}

template <int kDims, std::size_t kNodeSize>
class BoostTree : public BoxTree<kDims> {
 public:
  explicit BoostTree(std::span<const Aabb<kDims>> boxes)
      : tree_(TreeOf<kDims, kNodeSize>(boxes)) {}

  void Find(const Aabb<kDims>& query,
            std::vector<std::uint32_t>& found) const override {
    found.clear();
    tree_.query(bgi::intersects(BoostBoxOf(query)), IndexTaker(found));
  }

  bool CanCount() const override { return true; }
  std::size_t Count(const Aabb<kDims>& query) const override {
    return tree_.query(
        bgi::intersects(BoostBoxOf(query)),
        boost::make_function_output_iterator([](const auto& /*entry*/) {}));
  }

 private:
  bgi::rtree<Entry<kDims>, bgi::quadratic<kNodeSize>> tree_;
};

template <std::size_t kNodeSize>
class BoostNearest : public NearestTree {
 public:
  explicit BoostNearest(std::span<const Aabb3> boxes)
      : tree_(TreeOf<3, kNodeSize>(boxes)) {}

  void Nearest(const Point<3>& point, std::size_t count,
               std::vector<std::uint32_t>& found) override {
    found.clear();
    // Boost has no answer to this, but an assertion.
    if (count == 0) return;
    tree_.query(bgi::nearest(BoostPointOf(point), static_cast<unsigned>(count)),
                IndexTaker(found));
  }

 private:
  bgi::rtree<Entry<3>, bgi::quadratic<kNodeSize>> tree_;
};

template <std::size_t kNodeSize>
struct RegisterNodeSize {
  template <typename Interface, typename Tree>
  static void Register() {
    Registered<Interface>(
        "Boost R-tree, " + std::to_string(kNodeSize) + " a node",
        [](auto boxes) { return std::make_unique<Tree>(boxes); });
  }
  RegisterNodeSize() {
    Register<BoxTree<2>, BoostTree<2, kNodeSize>>();
    Register<BoxTree<3>, BoostTree<3, kNodeSize>>();
    Register<NearestTree, BoostNearest<kNodeSize>>();
  }
};
// Nodes of 32 were the fastest in one of 24 worlds, by 1 %.
const RegisterNodeSize<8> kNodesOf8;
const RegisterNodeSize<16> kNodesOf16;

}  // namespace
}  // namespace halfspace::bench
