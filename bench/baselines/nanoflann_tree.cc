#include <algorithm>
#include <nanoflann.hpp>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

// The names are those that nanoflann calls.
template <int kDims>
struct Cloud {
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return points[index][axis];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;  // let nanoflann compute it
  }

  std::vector<Point<kDims>> points;
};

template <int kDims>
class NanoflannTree : public NearestTree<kDims> {
 public:
  explicit NanoflannTree(std::span<const Point<kDims>> points)
      : cloud_{{points.begin(), points.end()}}, tree_(kDims, cloud_) {}

  void Nearest(const Point<kDims>& point, std::size_t count,
               std::vector<std::uint32_t>& found) override {
    found.resize(std::min(count, cloud_.points.size()));
    if (found.empty()) return;  // nanoflann would look at the last of them
    distances_.resize(found.size());
    tree_.knnSearch(point.data(), found.size(), found.data(),
                    distances_.data());
  }

 private:
  using Metric = nanoflann::L2_Simple_Adaptor<float, Cloud<kDims>>;

  Cloud<kDims> cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud<kDims>, kDims,
                                      std::uint32_t>
      tree_;
  std::vector<float> distances_;
};

}  // namespace

std::unique_ptr<NearestTree<2>> MakeNanoflann(
    std::span<const Point<2>> points) {
  return std::make_unique<NanoflannTree<2>>(points);
}
std::unique_ptr<NearestTree<3>> MakeNanoflann(
    std::span<const Point<3>> points) {
  return std::make_unique<NanoflannTree<3>>(points);
}

}  // namespace halfspace::bench
