#include "tests/library/bvh/any_bvh.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "tests/library/bvh/searches_of.h"

namespace halfspace::testing {
namespace {

template <typename View>
class BvhOf final : public SearchesOf<AnyBvh, Bvh<View>> {
  using Base = SearchesOf<AnyBvh, Bvh<View>>;
  using Base::kDims;
  using Base::world_;

 public:
  using Bound = typename View::Bound;
  using Base::Base;
  BvhOf(const BoundList& bounds, const BuildOptions& options)
      : Base(Build(bounds, options)) {}

  const detail::BvhTree& tree() const override {
    return detail::TreeOf(world_);
  }
  Planes Get(std::uint32_t id) const override {
    return Base::PlanesOf(world_.Get(id));
  }
  Planes Bounds() const override { return Base::PlanesOf(world_.Bounds()); }

  void CountEach(std::span<const Shape> bounds, Span<std::size_t> counts,
                 const QueryOptions& options) const override {
    std::vector<typename View::Query> queries(bounds.size());
    for (std::size_t q = 0; q < queries.size(); ++q) {
      for (std::size_t p = 0; p < kPlanes<View>; ++p) {
        OpposingValue<View>(queries[q], p) = bounds[q].numbers[p];
      }
    }
    CountSurvivorsOfEach(world_, queries, counts, options);
  }
  void ForEachNearest(const Corner& point, float max_distance,
                      const Searches::OnHit& function,
                      const SearchOptions& options) const override {
    halfspace::ForEachNearest(world_, Base::PointOf(point), max_distance,
                              Base::OnHitOf(function), options);
  }
  std::size_t FindPairs(const Searches* other,
                        const Span<const std::uint32_t>* ids,
                        Span<IdPair> pairs,
                        const PairOptions& options) const override {
    if constexpr (HasMaxima<View>) {
      if (ids != nullptr) {
        return other == nullptr
                   ? PairsOf(world_, *ids, pairs, options)
                   : PairsOf(world_, *ids, WorldOf(*other), pairs, options);
      }
      return other == nullptr ? Pairs(world_, pairs, options)
                              : Pairs(world_, WorldOf(*other), pairs, options);
    } else {
      std::abort();
    }
  }
  void ForEachPair(const Searches* other, const Span<const std::uint32_t>* ids,
                   const Searches::OnPairs& function,
                   const PairOptions& options) const override {
    if constexpr (HasMaxima<View>) {
      if (ids != nullptr && other != nullptr) {
        halfspace::ForEachPairOf(world_, *ids, WorldOf(*other), function,
                                 options);
      } else if (ids != nullptr) {
        halfspace::ForEachPairOf(world_, *ids, function, options);
      } else if (other != nullptr) {
        halfspace::ForEachPair(world_, WorldOf(*other), function, options);
      } else {
        halfspace::ForEachPair(world_, function, options);
      }
    }
  }
  void Update(PairEvents& events, const Span<const std::uint32_t>* changed,
              const PairEventOptions& options) const override {
    if constexpr (HasMaxima<View>) {
      if (changed == nullptr) {
        events.Update(world_, options);
      } else {
        events.Update(world_, *changed, options);
      }
    }
  }

  std::unique_ptr<AnyBvh> Copy() const override {
    return std::make_unique<BvhOf>(world_);
  }
  std::unique_ptr<AnyBvh> Loaded(Span<const std::byte> blob, bool is_in_place,
                                 const MemoryResource& memory) override {
    return std::make_unique<BvhOf>(is_in_place
                                       ? Bvh<View>::InPlace(blob, memory)
                                       : Bvh<View>::FromBlob(blob, memory));
  }
  void Insert(const BoundList& bounds, Span<std::uint32_t> ids) override {
    With(bounds, [&](const auto& list) { world_.Insert(list, ids); });
  }
  void InsertAs(Span<const std::uint32_t> ids,
                const BoundList& bounds) override {
    With(bounds, [&](const auto& list) { world_.InsertAs(ids, list); });
  }
  void Set(Span<const std::uint32_t> ids, const BoundList& bounds) override {
    With(bounds, [&](const auto& list) { world_.Set(ids, list); });
  }
  std::uint32_t InsertOne(const BoundList& bound) override {
    std::uint32_t id = 0;
    With(bound, [&](const auto& list) { id = world_.Insert(list[0]); });
    return id;
  }
  void SetOne(std::uint32_t id, const BoundList& bound) override {
    With(bound, [&](const auto& list) { world_.Set(id, list[0]); });
  }
  void EraseOne(std::uint32_t id) override { world_.Erase(id); }
  void Erase(Span<const std::uint32_t> ids) override { world_.Erase(ids); }
  void Refit(const BoundList& by_id, const Runner& run) override {
    With(by_id, [&](const auto& list) { world_.Refit(list, run); });
  }
  void RefitInOrder(const BoundList& bounds, const Runner& run) override {
    With(bounds, [&](const auto& list) { world_.RefitInOrder(list, run); });
  }
  void RefitSome(Span<const std::uint32_t> ids,
                 const BoundList& by_id) override {
    world_.Refit(ids, Base::BoundsOf(by_id.floats));
  }
  void SetMask(std::uint32_t id, std::uint32_t mask) override {
    world_.SetMasks(id, mask);
  }
  void SetMasks(Span<const std::uint32_t> masks) override {
    world_.SetMasks(masks);
  }
  void Reserve(std::size_t objects) override { world_.Reserve(objects); }
  void Clear() override { world_.Clear(); }
  void Rebuild(const BuildOptions& options) override {
    world_.Rebuild(options);
  }
  std::size_t RebuildPartial(std::size_t objects) override {
    return world_.RebuildPartial(objects);
  }

 private:
  static const Bvh<View>& WorldOf(const Searches& any) {
    return static_cast<const BvhOf&>(any).world_;
  }
  // call(bounds) with a vector of bounds of floats or of doubles.
  template <typename Call>
  static void With(const BoundList& bounds, const Call& call) {
    if constexpr (detail::kIsOfBoxes<View>) {
      if (!bounds.doubles.empty()) {
        std::vector<Aabb<kDims, double>> boxes(bounds.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
          for (std::size_t k = 0; k < kDims; ++k) {
            boxes[i].min[k] = bounds.doubles[i][k];
            boxes[i].max[k] = bounds.doubles[i][kDims + k];
          }
        }
        return call(boxes);
      }
    }
    call(Base::BoundsOf(bounds.floats));
  }
  static Bvh<View> Build(const BoundList& bounds, const BuildOptions& options) {
    Bvh<View> world(options.memory);
    With(bounds, [&](const auto& list) { world = Bvh<View>(list, options); });
    return world;
  }
};

}  // namespace

std::unique_ptr<AnyBvh> MakeBvh(const Layout& layout, const BoundList& bounds,
                                const BuildOptions& options) {
  const auto make = [&](auto view) -> std::unique_ptr<AnyBvh> {
    return std::make_unique<BvhOf<decltype(view)>>(bounds, options);
  };
#if !defined(HALFSPACE_TEST_ONLY_3D)
  if (layout.dims == 2) {
    return layout.kind == Layout::kSimplex ? make(SimplexView2())
           : layout.kind == Layout::kAabb  ? make(AabbView2())
                                           : make(AaboView2());
  }
#endif
  return layout.kind == Layout::kSimplex ? make(SimplexView3())
         : layout.kind == Layout::kAabb  ? make(AabbView3())
                                         : make(AaboView3());
}

}  // namespace halfspace::testing
