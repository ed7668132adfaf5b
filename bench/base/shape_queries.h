// The same queries for all three shapes, as the calls for many queries take
// them.
#ifndef HALFSPACE_BENCH_BASE_SHAPE_QUERIES_H_
#define HALFSPACE_BENCH_BASE_SHAPE_QUERIES_H_

#include <span>
#include <vector>

#include "bench/base/shape.h"
#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::bench {

class ShapeQueries {
 public:
  explicit ShapeQueries(std::span<const Aabo3> queries)
      : aabos_(queries.begin(), queries.end()) {
    for (const Aabo3& query : aabos_) {
      boxes_.push_back(query.aabb());
      simplices_.push_back(query.down());
    }
  }

  std::size_t size() const { return aabos_.size(); }
  std::span<const Aabo3> aabos() const { return aabos_; }
  std::span<const DownSimplex3> simplices() const { return simplices_; }

  // Calls f(view, queries) with the shape's own view of the octahedra.
  template <typename F>
  auto With(ShapeKind shape, const AaboView3& view, F&& f) const {
    switch (shape) {
      case ShapeKind::kAabb:
        return f(view.aabb(), std::span<const Aabb3>(boxes_));
      case ShapeKind::kSimplex:
        return f(view.simplex(), simplices());
      case ShapeKind::kAabo:
        break;
    }
    return f(view, aabos());
  }

 private:
  std::vector<Aabo3> aabos_;
  std::vector<Aabb3> boxes_;
  std::vector<DownSimplex3> simplices_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_SHAPE_QUERIES_H_
