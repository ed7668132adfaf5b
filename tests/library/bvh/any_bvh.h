// BVHs, and the queries that broad phases share with them, after their types
// are gone. Tests of answers are compiled once for every kind of world.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_ANY_BVH_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_ANY_BVH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "dispatch/bvh/tree.h"
#include "halfspace/halfspace.h"

namespace halfspace::testing {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kMost = std::numeric_limits<float>::max();

using Ids = std::vector<std::uint32_t>;
using Layout = detail::PlaneLayout;  // the kind of a world

inline std::string NameOf(const Layout& layout) {
  constexpr const char* kNames[] = {"Simplex", "Aabb", "Aabo"};
  return kNames[layout.kind] + std::to_string(layout.dims);
}
// The kinds of worlds that BVHs and broad phases have, as far as this build
// tests them.
inline std::vector<Layout> LayoutsOf(bool has_max_alone) {
  std::vector<Layout> layouts;
#if defined(HALFSPACE_TEST_ONLY_3D)
  for (std::size_t dims : {3u}) {
#else
  for (std::size_t dims : {2u, 3u}) {
#endif
    if (!has_max_alone) layouts.emplace_back(dims, dims + 1, false);
    layouts.emplace_back(dims, dims, true);
    layouts.emplace_back(dims, dims + 1, true);
  }
  return layouts;
}

// The values of a bound: all minima, then all maxima. As a query, the value
// that each plane is compared with.
using Planes = std::array<float, 8>;

inline bool IsMin(const Layout& layout, std::size_t p) {
  return p < layout.axes;
}
inline Planes AllPlanes(const Layout& layout, float of_minima) {
  Planes planes{};
  for (std::size_t p = 0; p < layout.plane_count; ++p) {
    planes[p] = IsMin(layout, p) ? of_minima : -of_minima;
  }
  return planes;
}
inline Planes EverythingOf(const Layout& layout) {
  return AllPlanes(layout, -kMost);
}
inline Planes EmptyOf(const Layout& layout) { return AllPlanes(layout, kInf); }

// Bounds for a call that changes a world: of floats, or of doubles that are
// rounded outward to these floats.
struct BoundList {
  std::vector<Planes> floats;
  std::vector<std::array<double, 8>> doubles;  // empty if they are floats

  std::size_t size() const { return floats.size(); }
};

struct Shape {
  enum Kind : std::uint8_t {
    kBound,
    kPoint,
    kSphere,
    kSegment,
    kCapsule,
    kRoundedBox,
    kOrientedBox,
    kHalfSpaces,
  };
  Kind kind = kBound;
  std::vector<float> numbers;  // as the struct has them, or Planes
};

using Corner = std::array<float, 3>;
// A box, or a point.
struct Place {
  Corner min{};
  Corner max{};
  bool is_point = false;
};
struct Motion {
  enum Kind : std::uint8_t { kRay, kBox, kBall };
  Kind kind = kRay;
  Place place;
  Corner direction{};
  float max_t = 0;
  float radius = 0;  // of a ray or a ball
};

// What a BVH and a broad phase answer.
class Searches {
 public:
  using OnIds = std::function<Visit(Span<const std::uint32_t>)>;
  using OnHit =
      std::function<Limit(std::uint32_t, float value, const Planes& bound)>;
  using OnPairs = std::function<Visit(Span<const IdPair>)>;

  explicit Searches(const Layout& its_layout) : layout(its_layout) {}
  virtual ~Searches() = default;
  const Layout layout;

  virtual std::size_t size() const = 0;
  virtual std::size_t Find(const Shape& shape, Span<std::uint32_t> ids,
                           const QueryOptions& options,
                           std::size_t skip) const = 0;
  virtual std::size_t Count(const Shape& shape,
                            const QueryOptions& options) const = 0;
  virtual std::optional<std::uint32_t> Any(
      const Shape& shape, const QueryOptions& options) const = 0;
  virtual void ForEach(const Shape& shape, const OnIds& function,
                       const QueryOptions& options) const = 0;
  // Shapes of one kind.
  virtual std::size_t FindEach(std::span<const Shape> shapes,
                               Span<std::uint32_t> ids,
                               Span<std::size_t> offsets,
                               const QueryOptions& options,
                               std::size_t skip) const = 0;
  virtual std::size_t Nearest(const Place& place, Span<std::uint32_t> ids,
                              Span<float> distances, float max_distance,
                              const SearchOptions& options) const = 0;
  virtual void NearestEach(std::span<const Place> places, std::size_t k,
                           Span<std::uint32_t> ids, Span<float> distances,
                           float max_distance,
                           const SearchOptions& options) const = 0;
  virtual void Cast(const Motion& motion, const OnHit& function,
                    const SearchOptions& options) const = 0;
  // Not of simplices. In one world, or of a BVH with another one; of some
  // objects, or of all of a BVH.
  virtual std::size_t FindPairs(const Searches* other,
                                const Span<const std::uint32_t>* ids,
                                Span<IdPair> pairs,
                                const PairOptions& options) const = 0;
  virtual void ForEachPair(const Searches* other,
                           const Span<const std::uint32_t>* ids,
                           const OnPairs& function,
                           const PairOptions& options) const = 0;
};

class AnyBvh : public Searches {
 public:
  using Searches::Searches;

  virtual const detail::BvhTree& tree() const = 0;
  virtual Planes Get(std::uint32_t id) const = 0;
  virtual Planes Bounds() const = 0;
  virtual void CountEach(std::span<const Shape> bounds,
                         Span<std::size_t> counts,
                         const QueryOptions& options) const = 0;
  virtual void ForEachNearest(const Corner& point, float max_distance,
                              const OnHit& function,
                              const SearchOptions& options) const = 0;
  virtual void Update(PairEvents& events,
                      const Span<const std::uint32_t>* changed,
                      const PairEventOptions& options) const = 0;

  virtual std::unique_ptr<AnyBvh> Copy() const = 0;
  virtual std::unique_ptr<AnyBvh> Loaded(Span<const std::byte> blob,
                                         bool is_in_place,
                                         const MemoryResource& memory) = 0;
  virtual void Insert(const BoundList& bounds, Span<std::uint32_t> ids) = 0;
  virtual void InsertAs(Span<const std::uint32_t> ids,
                        const BoundList& bounds) = 0;
  virtual void Set(Span<const std::uint32_t> ids, const BoundList& bounds) = 0;
  // Of one object, which have calls of their own.
  virtual std::uint32_t InsertOne(const BoundList& bound) = 0;
  virtual void SetOne(std::uint32_t id, const BoundList& bound) = 0;
  virtual void EraseOne(std::uint32_t id) = 0;
  virtual void Erase(Span<const std::uint32_t> ids) = 0;
  virtual void Refit(const BoundList& by_id, const Runner& run) = 0;
  virtual void RefitInOrder(const BoundList& bounds, const Runner& run) = 0;
  virtual void RefitSome(Span<const std::uint32_t> ids,
                         const BoundList& by_id) = 0;
  virtual void SetMask(std::uint32_t id, std::uint32_t mask) = 0;
  virtual void SetMasks(Span<const std::uint32_t> masks) = 0;
  virtual void Reserve(std::size_t objects) = 0;
  virtual void Clear() = 0;
  virtual void Rebuild(const BuildOptions& options) = 0;
  virtual std::size_t RebuildPartial(std::size_t objects) = 0;
};

std::unique_ptr<AnyBvh> MakeBvh(const Layout& layout, const BoundList& bounds,
                                const BuildOptions& options = {});
inline std::unique_ptr<AnyBvh> MakeBvh(const Layout& layout,
                                       const std::vector<Planes>& bounds,
                                       const BuildOptions& options = {}) {
  return MakeBvh(layout, BoundList{bounds, {}}, options);
}

// Each test runs once for each kind of world.
struct LayoutName {
  template <typename Info>
  std::string operator()(const Info& info) const {
    return NameOf(info.param);
  }
};

}  // namespace halfspace::testing

namespace halfspace::detail {
inline void PrintTo(const PlaneLayout& layout, std::ostream* out) {
  *out << testing::NameOf(layout);
}
}  // namespace halfspace::detail

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_ANY_BVH_H_
