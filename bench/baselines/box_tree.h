// Competitors: what other libraries offer for boxes, which a user might take
// instead. One question at a time, in one thread.
//
// Boxes are closed: those that touch count. Boxes and queries are finite, and
// no minimum is above its maximum. A competitor copies the boxes when it is
// made, and does then whatever it can do before it is asked. Its file registers
// it, if its library was found when this was built.
//
// What is found replaces what the vector held. Nothing is allocated for it if
// it fits what the caller reserved.
#ifndef HALFSPACE_BENCH_BASELINES_BOX_TREE_H_
#define HALFSPACE_BENCH_BASELINES_BOX_TREE_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
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

// Something that a library offers: its name, and how it is made of an input.
template <typename Interface>
struct Registered {
  using Make = std::function<std::unique_ptr<Interface>(
      const typename Interface::Input& input)>;

  // Adds it to All(). Of more than `most` boxes it takes seconds.
  Registered(std::string its_name, Make how,
             std::size_t most_boxes = std::numeric_limits<std::size_t>::max())
      : name(std::move(its_name)), make(std::move(how)), most(most_boxes) {
    All().push_back(*this);
  }

  static std::vector<Registered>& All() {
    static std::vector<Registered> all;
    return all;
  }

  // Those for so many boxes.
  static std::vector<Registered> AllFor(std::size_t boxes) {
    std::vector<Registered> all = All();
    std::erase_if(all, [boxes](const auto& each) { return boxes > each.most; });
    return all;
  }

  std::string name;
  Make make;
  std::size_t most;
  bool is_ours = false;  // a way to use the library
};

template <int kDims>
class BoxTree : public Competitor {
 public:
  using Input = std::span<const Aabb<kDims>>;

  // The indices of the boxes that touch the query, in any order.
  virtual void Find(const Aabb<kDims>& query,
                    std::vector<std::uint32_t>& found) const = 0;
  // How many these are, if the library can count without listing them.
  virtual bool CanCount() const { return false; }
  virtual std::size_t Count(const Aabb<kDims>& /*query*/) const { return 0; }
};

class NearestTree : public Competitor {
 public:
  using Input = std::span<const Aabb3>;

  // The indices of the `count` boxes, or all if these are fewer, that are
  // nearest to the point, in any order. 0 is the distance of a box from a point
  // in it.
  virtual void Nearest(const Point<3>& point, std::size_t count,
                       std::vector<std::uint32_t>& found) = 0;
};

using IndexPair = std::array<std::uint32_t, 2>;

class PairFinder : public Competitor {
 public:
  using Input = std::span<const Aabb3>;

  // Which boxes touch one another: each pair once, in any order, as are the two
  // of a pair.
  virtual void Pairs(std::vector<IndexPair>& found) = 0;
};

// The test that a competitor leaves to its user. Without branches, as what a
// tree comes upon is hard to predict.
template <int kDims>
bool Touches(const Aabb<kDims>& a, const Aabb<kDims>& b) {
  bool touches = true;
  for (std::size_t k = 0; k < a.min.size(); ++k) {
    touches &= a.min[k] <= b.max[k];
    touches &= b.min[k] <= a.max[k];
  }
  return touches;
}

// Whether these are the `count` boxes nearest to a point, or all if these are
// fewer, by a loop over all boxes. Many are equally far away, so the distance
// of the last is compared, which floats round.
inline bool AreNearest(std::span<const Aabb3> boxes, const Point<3>& point,
                       std::size_t count, std::span<const std::uint32_t> ids) {
  const auto square_of = [&point](const Aabb3& box) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double beyond =
          std::max({box.min[k] - point[k], point[k] - box.max[k], 0.0f});
      square += beyond * beyond;
    }
    return square;
  };
  if (ids.size() != std::min(count, boxes.size())) return false;
  std::vector<double> squares;
  for (const Aabb3& box : boxes) squares.push_back(square_of(box));
  const auto last =
      squares.begin() + static_cast<std::ptrdiff_t>(ids.size()) - 1;
  std::nth_element(squares.begin(), last, squares.end());
  double most = 0;
  for (std::uint32_t id : ids) most = std::max(most, square_of(boxes[id]));
  return most <= (1 + 1e-5) * *last;
}

// A tree of triangles. It tests them in floats, so a ray that hits an edge may
// pass.
class TriangleTree : public Competitor {
 public:
  using Input = std::span<const Triangle3>;

  // The t of the first hit, or infinity.
  virtual float FirstHit(const Ray<3>& ray) const = 0;
  virtual bool IsHit(const Ray<3>& ray) const = 0;
  // The distance of the closest point.
  virtual float Distance(const Point<3>& point) const = 0;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BOX_TREE_H_
