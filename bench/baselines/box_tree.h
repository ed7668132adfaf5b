// Competitors: trees of boxes that other libraries offer, which a user might
// take instead of a scan.
#ifndef HALFSPACE_BENCH_BASELINES_BOX_TREE_H_
#define HALFSPACE_BENCH_BASELINES_BOX_TREE_H_

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "halfspace/bounds.h"

namespace halfspace::bench {

class BoxTree {
 public:
  BoxTree() = default;
  BoxTree(const BoxTree&) = delete;
  BoxTree& operator=(const BoxTree&) = delete;
  virtual ~BoxTree() = default;

  // Replaces `found` by the indices of the boxes that touch the query, in any
  // order.
  virtual void Find(const Aabb3& query,
                    std::vector<std::uint32_t>& found) const = 0;
};

// Boost.Geometry's R-tree, quadratic<16>, packed from all boxes at once.
std::unique_ptr<BoxTree> MakeBoostTree(std::span<const Aabb3> boxes);

// Bullet's btDbvt, built by insertion and then optimised from the top down.
std::unique_ptr<BoxTree> MakeBulletTree(std::span<const Aabb3> boxes);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BOX_TREE_H_
