// What GEOS wants to be told by those who use its C++ interface.
#define USE_UNSTABLE_GEOS_CPP_API

#include <geos/geom/Envelope.h>
#include <geos/index/strtree/TemplateSTRtree.h>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

geos::geom::Envelope EnvelopeOf(const Aabb2& box) {
  return {box.min[0], box.max[0], box.min[1], box.max[1]};
}

class GeosTree : public BoxTree<2> {
 public:
  explicit GeosTree(std::span<const Aabb2> boxes)
      : tree_(kNodeSize, boxes.size()) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      tree_.insert(EnvelopeOf(boxes[i]), static_cast<std::uint32_t>(i));
    }
    tree_.build();
  }

  void Find(const Aabb2& query,
            std::vector<std::uint32_t>& found) const override {
    found.clear();
    tree_.query(EnvelopeOf(query), found);
  }

 private:
  static constexpr std::size_t kNodeSize = 10;  // GEOS's own choice

  // A query would build what is not built yet, so that it is not const.
  mutable geos::index::strtree::TemplateSTRtree<std::uint32_t> tree_;
};

const Registered<BoxTree<2>> kGeos("GEOS STRtree", [](auto boxes) {
  return std::make_unique<GeosTree>(boxes);
});

}  // namespace
}  // namespace halfspace::bench
