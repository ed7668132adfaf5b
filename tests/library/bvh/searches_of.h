// The queries of one type of BVH or broad phase, by the calls of the interface.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_SEARCHES_OF_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_SEARCHES_OF_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "tests/library/bvh/any_bvh.h"
#include "tests/library/support/cases.h"

namespace halfspace::testing {

// `Base` is Searches, or has more than it. `Held` is a World or a reference.
template <typename Base, typename World, typename Held = World>
class SearchesOf : public Base {
 public:
  using View = typename World::View;
  using Bound = typename View::Bound;
  static constexpr int kDims = Bound::kDimensions;

  explicit SearchesOf(Held world)
      : Base(detail::kLayoutOf<Bound>), world_(static_cast<Held&&>(world)) {}

  std::size_t size() const override { return world_.size(); }
  std::size_t Find(const Shape& shape, Span<std::uint32_t> ids,
                   const QueryOptions& options,
                   std::size_t skip) const override {
    return Ask({&shape, 1}, [&](const auto& queries) {
      return Survivors(world_, queries[0], ids, options, skip);
    });
  }
  std::size_t Count(const Shape& shape,
                    const QueryOptions& options) const override {
    return Ask({&shape, 1}, [&](const auto& queries) {
      return CountSurvivors(world_, queries[0], options);
    });
  }
  std::optional<std::uint32_t> Any(const Shape& shape,
                                   const QueryOptions& options) const override {
    return Ask({&shape, 1}, [&](const auto& queries) {
      return AnySurvivor(world_, queries[0], options);
    });
  }
  void ForEach(const Shape& shape, const Searches::OnIds& function,
               const QueryOptions& options) const override {
    Ask({&shape, 1}, [&](const auto& queries) {
      ForEachSurvivor(world_, queries[0], function, options);
    });
  }
  std::size_t FindEach(std::span<const Shape> shapes, Span<std::uint32_t> ids,
                       Span<std::size_t> offsets, const QueryOptions& options,
                       std::size_t skip) const override {
    return Ask(shapes, [&](const auto& queries) {
      return SurvivorsOfEach(world_, queries, ids, offsets, options, skip);
    });
  }
  std::size_t Nearest(const Place& place, Span<std::uint32_t> ids,
                      Span<float> distances, float max_distance,
                      const SearchOptions& options) const override {
    if (place.is_point) {
      return KNearest(world_, PointOf(place.min), ids, distances, max_distance,
                      options);
    }
    return KNearest(world_, BoxOf(place), ids, distances, max_distance,
                    options);
  }
  void NearestEach(std::span<const Place> places, std::size_t k,
                   Span<std::uint32_t> ids, Span<float> distances,
                   float max_distance,
                   const SearchOptions& options) const override {
    std::vector<Point<kDims>> points;
    std::vector<Aabb<kDims>> boxes;
    for (const Place& place : places) {
      points.push_back(PointOf(place.min));
      boxes.push_back(BoxOf(place));
    }
    if (places[0].is_point) {
      KNearestOfEach(world_, points, k, ids, distances, max_distance, options);
    } else {
      KNearestOfEach(world_, boxes, k, ids, distances, max_distance, options);
    }
  }
  void Cast(const Motion& motion, const Searches::OnHit& function,
            const SearchOptions& options) const override {
    const auto call = OnHitOf(function);
    const Point<kDims> from = PointOf(motion.place.min);
    const Point<kDims> direction = PointOf(motion.direction);
    switch (motion.kind) {
      case Motion::kRay:
        return RayCast(world_, Ray<kDims>{from, direction, motion.max_t},
                       motion.radius, call, options);
      case Motion::kBox:
        return BoxCast(world_, BoxOf(motion.place), direction, motion.max_t,
                       call, options);
      case Motion::kBall:
        return SphereCast(world_, Sphere<kDims>{from, motion.radius}, direction,
                          motion.max_t, call, options);
    }
  }

 protected:
  static Bound BoundOf(const Planes& planes) {
    Bound bound{};
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      StoredValue<View>(bound, p) = planes[p];
    }
    return bound;
  }
  static std::vector<Bound> BoundsOf(const std::vector<Planes>& all) {
    std::vector<Bound> bounds;
    bounds.reserve(all.size());
    for (const Planes& planes : all) bounds.push_back(BoundOf(planes));
    return bounds;
  }
  static Planes PlanesOf(Bound bound) {
    Planes planes{};
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      planes[p] = StoredValue<View>(bound, p);
    }
    return planes;
  }
  static Point<kDims> PointOf(const Corner& corner) {
    Point<kDims> point;
    std::copy_n(corner.begin(), kDims, point.begin());
    return point;
  }
  static Aabb<kDims> BoxOf(const Place& place) {
    return {PointOf(place.min), PointOf(place.max)};
  }
  static auto OnHitOf(const Searches::OnHit& function) {
    return [&function](std::uint32_t id, float value, const Bound& bound) {
      return function(id, value, PlanesOf(bound));
    };
  }

  Held world_;

 private:
  template <typename Query>
  static Query From(const Shape& shape) {
    if constexpr (std::is_same_v<Query, typename View::Query>) {
      Query query{};
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        OpposingValue<View>(query, p) = shape.numbers[p];
      }
      return query;
    } else if constexpr (std::is_same_v<Query, std::vector<HalfSpace<kDims>>>) {
      Query list(shape.numbers.size() / (kDims + 1));
      if (list.empty()) return list;
      std::memcpy(static_cast<void*>(list.data()), shape.numbers.data(),
                  list.size() * sizeof(list[0]));
      return list;
    } else {
      Query query;
      std::memcpy(&query, shape.numbers.data(), sizeof(query));
      return query;
    }
  }
  template <typename Query, typename Call>
  static auto AskOf(std::span<const Shape> shapes, const Call& call) {
    std::vector<Query> queries;
    for (const Shape& shape : shapes) queries.push_back(From<Query>(shape));
    return call(queries);
  }
  // call(queries) with a vector of what the interface takes.
  template <typename Call>
  static auto Ask(std::span<const Shape> shapes, const Call& call) {
    switch (shapes.empty() ? Shape::kBound : shapes[0].kind) {
      case Shape::kPoint:
        return AskOf<Point<kDims>>(shapes, call);
      case Shape::kSphere:
        return AskOf<Sphere<kDims>>(shapes, call);
      case Shape::kSegment:
        return AskOf<Segment<kDims>>(shapes, call);
      case Shape::kCapsule:
        return AskOf<Capsule<kDims>>(shapes, call);
      case Shape::kRoundedBox:
        return AskOf<RoundedBox<kDims>>(shapes, call);
      case Shape::kOrientedBox:
        return AskOf<OrientedBox<kDims>>(shapes, call);
      case Shape::kHalfSpaces:
        return AskOf<std::vector<HalfSpace<kDims>>>(shapes, call);
      case Shape::kBound:
        break;
    }
    return AskOf<typename View::Query>(shapes, call);
  }
};

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_SEARCHES_OF_H_
