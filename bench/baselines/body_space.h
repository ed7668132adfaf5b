// Broad phases of other libraries, which the benchmarks compare with
// BroadPhase. A space calls the fastest interface of its library, in one
// thread.
//
// Boxes are closed, finite and not inverted. Ids are 0 to `bodies - 1`. The
// answers are those of the exact boxes: a space with larger boxes tests the
// exact ones within the call. Its file registers it by the number of bodies.
#ifndef HALFSPACE_BENCH_BASELINES_BODY_SPACE_H_
#define HALFSPACE_BENCH_BASELINES_BODY_SPACE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "bench/baselines/box_tree.h"
#include "bench/baselines/touches.h"
#include "halfspace/bounds.h"
#include "halfspace/shapes.h"

namespace halfspace::bench {

// Convert an id to the pointer that a library stores with a body, and back.
inline void* DataOf(std::uint32_t id) {
  // NOLINTNEXTLINE(performance-no-int-to-ptr): it points to nothing.
  return reinterpret_cast<void*>(std::uintptr_t{id});
}
inline std::uint32_t IdOfData(const void* data) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(data));
}

// A query by a shape. The shape of kBox is `box`, which can be a point.
template <int kDims>
struct BodyQuery {
  enum class Kind : std::uint8_t { kBox, kSphere, kOrientedBox };

  Kind kind;
  bool is_first;    // one body is enough
  Aabb<kDims> box;  // around the shape
  Sphere<kDims> sphere;
  OrientedBox<kDims> oriented;  // its axes are of length 1, and orthogonal

  // The tests of bvh_shapes.h, without its rounding.
  bool Finds(const Aabb<kDims>& body) const {
    if (!Touches(box, body)) return false;
    if (kind == Kind::kSphere) {
      float square = 0;
      for (std::size_t k = 0; k < kDims; ++k) {
        const float gap = std::max({0.0f, body.min[k] - sphere.center[k],
                                    sphere.center[k] - body.max[k]});
        square += gap * gap;
      }
      return square <= sphere.radius * sphere.radius;
    }
    if (kind == Kind::kOrientedBox) {
      for (std::size_t a = 0; a < kDims; ++a) {
        float distance = 0;
        float reach = oriented.half_extents[a];
        for (std::size_t k = 0; k < kDims; ++k) {
          const float axis = oriented.axes[a][k];
          const float middle = 0.5f * (body.min[k] + body.max[k]);
          distance += axis * (middle - oriented.center[k]);
          reach += 0.5f * std::abs(axis) * (body.max[k] - body.min[k]);
        }
        if (std::abs(distance) > reach) return false;
      }
    }
    return true;
  }
};

// A ray, whose box is its origin, or a box cast.
template <int kDims>
struct BodyCast {
  bool is_closest;
  Aabb<kDims> box;
  Point<kDims> direction;
  Point<kDims> inverse;  // of the direction, which has no 0
  float max_t;

  bool IsRay() const { return box.min == box.max; }
  // Returns the t at which the cast enters the body, or infinity if that is
  // beyond `limit`.
  float Enters(const Aabb<kDims>& body, float limit) const {
    float enter = 0;
    float leave = limit;
    for (std::size_t k = 0; k < kDims; ++k) {
      const float a = (body.min[k] - box.max[k]) * inverse[k];
      const float b = (body.max[k] - box.min[k]) * inverse[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave ? enter : std::numeric_limits<float>::infinity();
  }
  // Returns the box around the path up to t = `limit`.
  Aabb<kDims> Way(float limit) const {
    Aabb<kDims> way = box;
    for (std::size_t k = 0; k < kDims; ++k) {
      way.min[k] += std::min(0.0f, limit * direction[k]);
      way.max[k] += std::max(0.0f, limit * direction[k]);
    }
    return way;
  }
};

// The result of a cast: all bodies that it enters, or the closest one.
struct CastHits {
  std::size_t count = 0;
  float limit;  // the least t of the closest

  template <int kDims>
  void Test(const BodyCast<kDims>& cast, const Aabb<kDims>& body) {
    const float t = cast.Enters(body, limit);
    if (t > limit) return;
    ++count;
    if (cast.is_closest) limit = t;
  }
};

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
  // Appends the bodies that touch the query.
  virtual void Find(const BodyQuery<kDims>& query,
                    std::vector<std::uint32_t>& found) const = 0;
  virtual void Cast(const BodyCast<kDims>& cast, CastHits& hits) const = 0;
  // Whether it has casts of rays and of boxes.
  virtual bool CanCast() const { return true; }
  virtual bool CanCastBoxes() const { return CanCast(); }
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
  // The same by a query for each of `ids`: each(a, function) calls function(b)
  // for the bodies near a.
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
