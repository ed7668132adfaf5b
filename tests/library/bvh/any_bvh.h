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
  BoundList() = default;
  // NOLINTNEXTLINE(google-explicit-constructor)
  BoundList(std::vector<Planes> bounds) : floats(std::move(bounds)) {}

  std::vector<Planes> floats;
  std::vector<std::array<double, 8>> doubles = {};  // empty if they are floats

  std::size_t size() const { return floats.size(); }
  // NOLINTNEXTLINE(google-explicit-constructor): what trees take.
  operator detail::Columns() const {
    return doubles.empty()
               ? detail::ColumnsOfRows(AllOf(floats), size(), Planes().size())
               : detail::ColumnsOfRows(AllOf(doubles), size(), Planes().size());
  }

 private:
  template <typename Row>
  static const typename Row::value_type* AllOf(const std::vector<Row>& rows) {
    return rows.empty() ? nullptr : rows[0].data();
  }
};

struct Shape {
  // After the first as detail::BvhShapeQuery.
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
inline Shape ShapeOf(const Planes& query) {
  return {Shape::kBound, {query.begin(), query.end()}};
}

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

// What a BVH or a broad phase answers, by the library's own calls
// (detail/bvh.h, detail/broad_phase.h).
class Searches {
 public:
  using OnIds = std::function<Visit(Span<const std::uint32_t>)>;
  using OnHit =
      std::function<Limit(std::uint32_t, float value, const Planes& bound)>;
  using OnPairs = std::function<Visit(Span<const IdPair>)>;

  Searches(const Layout& its_layout, const detail::BvhTree& its_bvh)
      : layout(its_layout), bvh(&its_bvh) {}
  Searches(const Layout& its_layout, const detail::BroadPhaseCore& its_bodies)
      : layout(its_layout), bodies(&its_bodies) {}
  // The other one is null.
  const Layout layout;
  const detail::BvhTree* const bvh = nullptr;
  const detail::BroadPhaseCore* const bodies = nullptr;

  std::size_t size() const {
    return bvh == nullptr ? bodies->size() : bvh->size();
  }
  std::size_t Find(const Shape& shape, Span<std::uint32_t> ids,
                   const QueryOptions& options, std::size_t skip) const;
  std::size_t Count(const Shape& shape, const QueryOptions& options) const;
  std::optional<std::uint32_t> Any(const Shape& shape,
                                   const QueryOptions& options) const;
  void ForEach(const Shape& shape, const OnIds& function,
               const QueryOptions& options) const;
  // Shapes of one kind.
  std::size_t FindEach(std::span<const Shape> shapes, Span<std::uint32_t> ids,
                       Span<std::size_t> offsets, const QueryOptions& options,
                       std::size_t skip) const;
  std::size_t Nearest(const Place& place, Span<std::uint32_t> ids,
                      Span<float> distances, float max_distance,
                      const SearchOptions& options) const;
  void NearestEach(std::span<const Place> places, std::size_t k,
                   Span<std::uint32_t> ids, Span<float> distances,
                   float max_distance, const SearchOptions& options) const;
  void Cast(const Motion& motion, const OnHit& function,
            const SearchOptions& options) const;
  // Not of simplices. In one world, or of a BVH with another one; of some
  // objects, or of all of a BVH.
  std::size_t FindPairs(const Searches* other,
                        const Span<const std::uint32_t>* ids,
                        Span<IdPair> pairs, const PairOptions& options) const;
  void ForEachPair(const Searches* other, const Span<const std::uint32_t>* ids,
                   const OnPairs& function, const PairOptions& options) const;
  // Of BVHs alone.
  void CountEach(std::span<const Shape> bounds, Span<std::size_t> counts,
                 const QueryOptions& options) const;
  void ForEachNearest(const Corner& point, float max_distance,
                      const OnHit& function,
                      const SearchOptions& options) const;
};

detail::BvhType TypeOf(const Layout& layout);
const detail::BvhPairKernels* PairKernelsOf(const Layout& layout);
detail::PairSources PairSourcesOf(
    const Searches& world, const Searches* other = nullptr,
    const Span<const std::uint32_t>* ids = nullptr);

class AnyBvh : public detail::BvhTree, public Searches {
 public:
  AnyBvh(const Layout& its_layout, const MemoryResource& memory)
      : BvhTree(TypeOf(its_layout), memory), Searches(its_layout, *this) {}
  AnyBvh(const AnyBvh& other) : BvhTree(other), Searches(other.layout, *this) {}
  AnyBvh& operator=(const AnyBvh&) = delete;

  using BvhTree::size;
  using Searches::Any;
  using Searches::Cast;
  using Searches::Count;
  using Searches::ForEach;
  using Searches::ForEachNearest;
  using Searches::Nearest;
  Planes Get(std::uint32_t id) const {
    Planes planes{};
    BvhTree::Get(id, {planes.data(), layout.plane_count});
    return planes;
  }
  Planes Bounds() const {
    Planes planes{};
    BvhTree::Bounds({planes.data(), layout.plane_count});
    return planes;
  }
  std::unique_ptr<AnyBvh> Copy() const {
    return std::make_unique<AnyBvh>(*this);
  }
};

inline std::unique_ptr<AnyBvh> MakeBvh(const Layout& layout,
                                       const BoundList& bounds,
                                       const BuildOptions& options = {}) {
  auto bvh = std::make_unique<AnyBvh>(layout, options.memory);
  bvh->Build(bounds, options);
  return bvh;
}
inline std::unique_ptr<AnyBvh> LoadBvh(const Layout& layout,
                                       Span<const std::byte> blob,
                                       bool is_in_place,
                                       const MemoryResource& memory = {}) {
  auto bvh = std::make_unique<AnyBvh>(layout, memory);
  bvh->Load(blob, is_in_place);
  return bvh;
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
