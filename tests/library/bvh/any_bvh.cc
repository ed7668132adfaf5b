#include "tests/library/bvh/any_bvh.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace halfspace::testing {
namespace {

// The kernels of a layout: Of is a template of detail/bvh.h.
template <template <std::size_t kAxes> typename Of>
auto KernelsOf(const Layout& layout) {
#if !defined(HALFSPACE_TEST_ONLY_3D)
  if (layout.axes == 2) return Of<2>::kTargets;
#endif
  return layout.axes == 3 ? Of<3>::kTargets : Of<4>::kTargets;
}

// Queries by shapes of one kind, as trees take them.
class Asked {
 public:
  Asked(const Layout& layout, std::span<const Shape> shapes) {
    for (const Shape& shape : shapes) {
      const float* const values = shape.numbers.data();
      if (shape.kind == Shape::kBound) {
        // Minima are compared with maxima, which come last.
        const float* const minima = values + layout.axes;
        bounds_.insert(bounds_.end(), minima, values + layout.plane_count);
        bounds_.insert(bounds_.end(), values, minima);
        continue;
      }
      const auto kind =
          static_cast<detail::BvhShapeQuery::Kind>(shape.kind - 1);
      const bool is_list = shape.kind == Shape::kHalfSpaces;
      shapes_.push_back(
          {kind, layout.dims, values,
           is_list ? shape.numbers.size() / (layout.dims + 1u) : 1});
    }
    queries = shapes_.empty()
                  ? detail::BvhQueries{bounds_.data(), shapes.size()}
                  : detail::BvhQueries{shapes_.data(), shapes.size(), &kKind};
  }
  detail::BvhQueries queries;

 private:
  static constexpr detail::BvhShapeKind kKind = {
      alignof(detail::BvhShapeQuery),
      [](const void* shapes, std::size_t i) {
        return static_cast<const detail::BvhShapeQuery*>(shapes)[i];
      },
      &detail::BvhWalkShapes};

  std::vector<float> bounds_;
  std::vector<detail::BvhShapeQuery> shapes_;
};

detail::NearQueries NearQueriesOf(std::span<const Place> places) {
  static_assert(offsetof(Place, max) == sizeof(Corner));
  return {places[0].min.data(), places[0].is_point ? 0 : Corner().size(),
          sizeof(Place) / sizeof(float), places.size()};
}

auto WithPlanes(const Layout& layout, const Searches::OnHit& function) {
  return [&](std::uint32_t id, float value, const float* planes) {
    Planes bound{};
    for (std::size_t p = 0; p < layout.plane_count; ++p) {
      bound[p] = planes[p * detail::kBlockObjects];
    }
    return function(id, value, bound);
  };
}

}  // namespace

detail::BvhType TypeOf(const Layout& layout) {
  return {layout, KernelsOf<detail::BvhKernelsOf>(layout)};
}
const detail::BvhPairKernels* PairKernelsOf(const Layout& layout) {
  return KernelsOf<detail::BvhPairKernelsOf>(layout);
}

detail::PairSources PairSourcesOf(const Searches& world, const Searches* other,
                                  const Span<const std::uint32_t>* ids) {
  return {PairKernelsOf(world.layout), world.bvh,
          other == nullptr ? nullptr : other->bvh, ids};
}

// Returns ask(tree) of a BVH or a broad phase, which have the same calls.
template <class Ask>
static auto In(const Searches& searches, const Ask& ask) {
  return searches.bvh == nullptr ? ask(*searches.bodies) : ask(*searches.bvh);
}

std::size_t Searches::Find(const Shape& shape, Span<std::uint32_t> ids,
                           const QueryOptions& options,
                           std::size_t skip) const {
  const Asked asked(layout, {&shape, 1});
  return In(*this, [&](const auto& tree) {
    return tree.Survivors(asked.queries, ids, options, skip);
  });
}

std::size_t Searches::Count(const Shape& shape,
                            const QueryOptions& options) const {
  const Asked asked(layout, {&shape, 1});
  return In(*this, [&](const auto& tree) {
    return tree.Count(asked.queries, options);
  });
}

std::optional<std::uint32_t> Searches::Any(const Shape& shape,
                                           const QueryOptions& options) const {
  const Asked asked(layout, {&shape, 1});
  std::uint32_t id = 0;
  const bool is_found = In(*this, [&](const auto& tree) {
    return tree.Any(asked.queries, id, options);
  });
  return is_found ? std::optional(id) : std::nullopt;
}

void Searches::ForEach(const Shape& shape, const OnIds& function,
                       const QueryOptions& options) const {
  const Asked asked(layout, {&shape, 1});
  detail::Callback call{function};
  In(*this, [&](const auto& tree) {
    tree.ForEach(asked.queries, &decltype(call)::Run, &call, options);
  });
}

std::size_t Searches::FindEach(std::span<const Shape> shapes,
                               Span<std::uint32_t> ids,
                               Span<std::size_t> offsets,
                               const QueryOptions& options,
                               std::size_t skip) const {
  const Asked asked(layout, shapes);
  return In(*this, [&](const auto& tree) {
    return tree.SurvivorsOfEach(asked.queries, ids, offsets, options, skip);
  });
}

void Searches::CountEach(std::span<const Shape> bounds,
                         Span<std::size_t> counts,
                         const QueryOptions& options) const {
  const Asked asked(layout, bounds);
  bvh->CountOfEach(asked.queries, counts, options);
}

std::size_t Searches::Nearest(const Place& place, Span<std::uint32_t> ids,
                              Span<float> distances, float max_distance,
                              const SearchOptions& options) const {
  return In(*this, [&](const auto& tree) {
    return tree.Nearest(NearQueriesOf({&place, 1}), max_distance, ids,
                        distances, options);
  });
}

void Searches::NearestEach(std::span<const Place> places, std::size_t k,
                           Span<std::uint32_t> ids, Span<float> distances,
                           float max_distance,
                           const SearchOptions& options) const {
  In(*this, [&](const auto& tree) {
    tree.NearestOfEach(NearQueriesOf(places), k, max_distance, ids, distances,
                       options);
  });
}

void Searches::ForEachNearest(const Corner& point, float max_distance,
                              const OnHit& function,
                              const SearchOptions& options) const {
  detail::Callback call{WithPlanes(layout, function)};
  bvh->ForEachNearest({point.data(), 0, 0, 1}, max_distance,
                      &decltype(call)::Run, &call, options);
}

void Searches::Cast(const Motion& motion, const OnHit& function,
                    const SearchOptions& options) const {
  constexpr const char* kCalls[] = {"RayCast", "BoxCast", "SphereCast"};
  const Place& place = motion.place;
  const bool is_box = motion.kind == Motion::kBox;
  const detail::LineCast cast = {kCalls[motion.kind],
                                 place.min.data(),
                                 is_box ? place.max.data() : place.min.data(),
                                 motion.direction.data(),
                                 motion.max_t,
                                 is_box ? 0 : motion.radius,
                                 motion.kind == Motion::kBall};
  detail::Callback call{WithPlanes(layout, function)};
  In(*this, [&](const auto& tree) {
    tree.Cast(cast, &decltype(call)::Run, &call, options);
  });
}

std::size_t Searches::FindPairs(const Searches* other,
                                const Span<const std::uint32_t>* ids,
                                Span<IdPair> pairs,
                                const PairOptions& options) const {
  const detail::PairSources sources = PairSourcesOf(*this, other, ids);
  return bvh == nullptr ? bodies->PairsOf(sources.kernels, *ids, pairs, options)
                        : detail::BvhPairs(sources, pairs, options);
}

void Searches::ForEachPair(const Searches* other,
                           const Span<const std::uint32_t>* ids,
                           const OnPairs& function,
                           const PairOptions& options) const {
  const detail::PairSources sources = PairSourcesOf(*this, other, ids);
  detail::Callback call{function};
  const detail::PairsFunction run = &decltype(call)::Run;
  if (bvh == nullptr) {
    return bodies->ForEachPairOf(sources.kernels, *ids, run, &call, options);
  }
  detail::BvhForEachPair(sources, run, &call, options);
}

}  // namespace halfspace::testing
