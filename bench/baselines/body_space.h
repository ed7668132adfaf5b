// Broad phases of other libraries, and our own, which the benchmarks compare.
// A space calls the fastest interface of its library, in one
// thread.
//
// Boxes are closed, finite and not inverted. Ids are 0 to `bodies - 1`. The
// answers are those of the exact boxes: a space with larger boxes tests the
// exact ones within the call. Its file registers it by the number of bodies.
#ifndef HALFSPACE_BENCH_BASELINES_BODY_SPACE_H_
#define HALFSPACE_BENCH_BASELINES_BODY_SPACE_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bench/baselines/box_tree.h"
#include "halfspace/bounds.h"

namespace halfspace::bench {

// Convert an id to the pointer that a library stores with a body, and back.
inline void* DataOf(std::uint32_t id) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): it points to nothing.
  return reinterpret_cast<void*>(std::uintptr_t{id});
}
inline std::uint32_t IdOfData(const void* data) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(data));
}

template <int kDims>
class BodySpace : public Competitor {
 public:
  using Input = std::size_t;  // the number of bodies
  using Box = Aabb<kDims>;
  using Ids = std::span<const std::uint32_t>;
  using Boxes = std::span<const Box>;

  explicit BodySpace(std::size_t bodies) : boxes_(bodies), moved_(bodies) {}

  virtual void Insert(Ids ids, Boxes boxes) = 0;
  // Moves bodies, and does the work of a frame.
  virtual void Step(Ids ids, Boxes boxes) = 0;
  // Appends the pairs that touch and have a body of the last Step(), each once.
  virtual void PairsOf(Ids ids, std::vector<IndexPair>& found) = 0;
  // A stored corner may be beside the exact one by this share of its distance
  // from 0. A pair that touches by less may be missing.
  virtual float Slack() const { return 0; }

 protected:
  // Calls function(id, box) for each body, then stores its exact box.
  template <typename Function>
  void Store(Ids ids, Boxes boxes, Function function) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      function(ids[i], boxes[i]);
      boxes_[ids[i]] = boxes[i];
    }
  }
  // Appends the pairs that touch and have a body of `ids`. visit(function)
  // calls function(a, b) for the candidates.
  template <typename Visit>
  void PairsAmong(Ids ids, std::vector<IndexPair>& found, Visit visit) {
    for (std::uint32_t id : ids) moved_[id] = 1;
    visit([&](std::uint32_t a, std::uint32_t b) {
      if ((moved_[a] | moved_[b]) != 0 && Touches(boxes_[a], boxes_[b])) {
        found.push_back({a, b});
      }
    });
    for (std::uint32_t id : ids) moved_[id] = 0;
  }
  // Appends the pairs with one of `ids`. each(a, function) queries with body a,
  // and calls function(b) for the bodies near it.
  template <typename Each>
  void PairsByQueries(Ids ids, std::vector<IndexPair>& found, Each each) {
    for (std::uint32_t id : ids) moved_[id] = 1;
    for (std::uint32_t a : ids) {
      each(a, [&, a](std::uint32_t b) {
        const bool is_other = b < a || (b != a && moved_[b] == 0);
        if (is_other && Touches(boxes_[a], boxes_[b])) found.push_back({a, b});
      });
    }
    for (std::uint32_t id : ids) moved_[id] = 0;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint8_t> moved_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BODY_SPACE_H_
