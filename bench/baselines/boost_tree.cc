#include <boost/geometry.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <iterator>
#include <utility>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

namespace bg = boost::geometry;
namespace bgi = boost::geometry::index;

using Point = bg::model::point<float, 3, bg::cs::cartesian>;
using Box = bg::model::box<Point>;
using Entry = std::pair<Box, std::uint32_t>;

Box BoxOf(const Aabb3& box) {
  return {{box.min[0], box.min[1], box.min[2]},
          {box.max[0], box.max[1], box.max[2]}};
}

// Takes what a query finds, and keeps its index.
class IndexTaker {
 public:
  using iterator_category = std::output_iterator_tag;
  using value_type = void;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = void;

  explicit IndexTaker(std::vector<std::uint32_t>& found) : found_(&found) {}

  IndexTaker& operator=(const Entry& entry) {
    found_->push_back(entry.second);
    return *this;
  }
  IndexTaker& operator*() { return *this; }
  IndexTaker& operator++() { return *this; }
  IndexTaker operator++(int) { return *this; }

 private:
  std::vector<std::uint32_t>* found_;
};

class BoostTree : public BoxTree {
 public:
  explicit BoostTree(const std::vector<Entry>& entries) : tree_(entries) {}

  void Find(const Aabb3& query,
            std::vector<std::uint32_t>& found) const override {
    found.clear();
    tree_.query(bgi::intersects(BoxOf(query)), IndexTaker(found));
  }

 private:
  bgi::rtree<Entry, bgi::quadratic<16>> tree_;
};

}  // namespace

std::unique_ptr<BoxTree> MakeBoostTree(std::span<const Aabb3> boxes) {
  std::vector<Entry> entries;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    entries.emplace_back(BoxOf(boxes[i]), static_cast<std::uint32_t>(i));
  }
  return std::make_unique<BoostTree>(entries);
}

}  // namespace halfspace::bench
