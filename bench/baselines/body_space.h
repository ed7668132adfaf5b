// Broad phases of other libraries, which the benchmarks compare with
// BroadPhase. A space calls the fastest interface of its library, in one
// thread.
//
// Boxes are closed, finite and not inverted. Ids are 0 to `bodies - 1`. The
// answers are those of the exact boxes: a space with larger boxes tests the
// exact ones within the call. The factory of a library that was not installed
// when this was built returns nullptr.
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
#include "halfspace/bounds.h"
#include "halfspace/shapes.h"

namespace halfspace::bench {

template <int kDims>
bool Touch(const Aabb<kDims>& a, const Aabb<kDims>& b) {
  bool touch = true;
  for (std::size_t k = 0; k < kDims; ++k) {
    touch &= a.min[k] <= b.max[k];
    touch &= b.min[k] <= a.max[k];
  }
  return touch;
}

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
  bool Touches(const Aabb<kDims>& body) const {
    if (!Touch(box, body)) return false;
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
  using Box = Aabb<kDims>;
  using Ids = std::span<const std::uint32_t>;
  using Boxes = std::span<const Box>;

  explicit BodySpace(std::size_t bodies) : boxes_(bodies), moved_(bodies) {}

  virtual void Insert(Ids ids, Boxes boxes) = 0;
  // Moves bodies, and does the work of a frame.
  virtual void Step(Ids ids, Boxes boxes) = 0;
  // Appends the pairs that touch and have a body of the last Step(), each once.
  virtual void PairsOf(Ids ids, std::vector<IndexPair>& found) = 0;
  // Appends all pairs that touch, and returns their number. A space that
  // reports how its pairs change may return the number alone.
  virtual std::size_t AllPairs(std::vector<IndexPair>& found) = 0;
  // Appends the pairs of the last AllPairs(), of a space that returns their
  // number alone.
  virtual void ListPairs(std::vector<IndexPair>& /*found*/) const {}
  // Appends the bodies that touch the query.
  virtual void Find(const BodyQuery<kDims>& query,
                    std::vector<std::uint32_t>& found) const = 0;
  virtual void Cast(const BodyCast<kDims>& cast, CastHits& hits) const = 0;
  // Whether it has queries and casts that do not read all bodies.
  virtual bool CanFind() const { return true; }
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
  // Appends the pairs that touch: those with a body of `ids`, or all.
  // visit(function) calls function(a, b) for the candidates.
  template <typename Visit>
  void PairsAmong(Ids ids, std::vector<IndexPair>& found, Visit visit) {
    for (std::uint32_t id : ids) moved_[id] = 1;
    visit([&](std::uint32_t a, std::uint32_t b) {
      if ((moved_[a] | moved_[b]) != 0 && Touch(boxes_[a], boxes_[b])) {
        found.push_back({a, b});
      }
    });
    for (std::uint32_t id : ids) moved_[id] = 0;
  }
  template <typename Visit>
  std::size_t AllPairsAmong(std::vector<IndexPair>& found, Visit visit) const {
    visit([&](std::uint32_t a, std::uint32_t b) {
      if (Touch(boxes_[a], boxes_[b])) found.push_back({a, b});
    });
    return found.size();
  }
  // The same by a query for each of `ids`: each(a, function) calls function(b)
  // for the bodies near a.
  template <typename Each>
  void PairsByQueries(Ids ids, std::vector<IndexPair>& found, Each each) {
    for (std::uint32_t id : ids) moved_[id] = 1;
    for (std::uint32_t a : ids) {
      each(a, [&, a](std::uint32_t b) {
        const bool is_other = b < a || (b != a && moved_[b] == 0);
        if (is_other && Touch(boxes_[a], boxes_[b])) found.push_back({a, b});
      });
    }
    for (std::uint32_t id : ids) moved_[id] = 0;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint8_t> moved_;
};

template <int kDims>
using BodySpacePtr = std::unique_ptr<BodySpace<kDims>>;

// btDbvtBroadphase, with its cache of pairs. Its casts do not find a body that
// they only touch.
BodySpacePtr<3> MakeBulletSpace(std::size_t bodies);
// b2BroadPhase, with a list of contacts as b2ContactManager's.
BodySpacePtr<2> MakeBox2dSpace(std::size_t bodies);
// fcl::DynamicAABBTreeCollisionManager<float>.
BodySpacePtr<3> MakeFclSpace(std::size_t bodies);
// Our own flat scan.
template <int kDims>
BodySpacePtr<kDims> MakeScanSpace(std::size_t bodies);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_BODY_SPACE_H_
