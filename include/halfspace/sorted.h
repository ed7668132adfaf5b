#ifndef HALFSPACE_SORTED_H_
#define HALFSPACE_SORTED_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "halfspace/detail/sorted.h"
#include "halfspace/memory.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"

namespace halfspace {

enum class Order : std::uint8_t {
  kTight,
  kFast,
};

namespace detail {

template <typename View>
SortedShape SortedShapeOf() {
  using Bound = typename View::Bound;
  return {SortedKernelsOf<Bound::kAxes>::kTargets,
          static_cast<std::uint8_t>(Bound::kAxes), HasMax<Bound>};
}

template <typename Query>
const float* ValuesOf(const Query& query) {
  static_assert(std::is_standard_layout_v<Query> &&
                    sizeof(Query) == kPlaneCount<Query> * sizeof(float),
                "a query is read as a list of its values");
  return reinterpret_cast<const float*>(&query);
}

}  // namespace detail

template <typename ViewType>
class SortedWorld {
 public:
  using View = ViewType;
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  static_assert(std::is_same_v<typename Bound::Scalar, float>, "floats");
  static_assert(Bound::kDimensions <= 3, "2 or 3 dimensions");

  SortedWorld() : SortedWorld(MemoryResource()) {}
  explicit SortedWorld(const MemoryResource& memory)
      : tree_(detail::SortedShapeOf<View>(), memory) {}
  explicit SortedWorld(const View& world, Order order = Order::kTight,
                       const MemoryResource& memory = {})
      : SortedWorld(memory) {
    tree_.Build(detail::ColumnsOf(world), order, Target());
  }
  explicit SortedWorld(Span<const Bound> bounds, Order order = Order::kTight,
                       const MemoryResource& memory = {})
      : SortedWorld(memory) {
    tree_.Build(detail::ColumnsOf(bounds), order, Target());
  }
  SortedWorld(const SortedWorld& other, const MemoryResource& memory)
      : tree_(other.tree_, memory) {}

  friend void swap(SortedWorld& a, SortedWorld& b) noexcept {
    swap(a.tree_, b.tree_);
  }

  const MemoryResource& memory() const { return tree_.memory(); }
  std::size_t size() const { return tree_.size(); }
  bool empty() const { return size() == 0; }
  std::size_t bytes() const { return tree_.bytes(); }

  const detail::SortedTree& tree() const { return tree_; }

 private:
  detail::SortedTree tree_;
};

template <typename View>
[[nodiscard]] std::size_t Survivors(const SortedWorld<View>& world,
                                    const typename View::Query& query,
                                    Span<std::uint32_t> ids,
                                    Target target = {}) {
  return detail::SortedSurvivors(world.tree(), detail::ValuesOf(query), ids,
                                 target);
}

template <typename View>
[[nodiscard]] std::size_t CountSurvivors(const SortedWorld<View>& world,
                                         const typename View::Query& query,
                                         Target target = {}) {
  return detail::SortedCount(world.tree(), detail::ValuesOf(query), target);
}

template <typename View, typename Function>
void ForEachSurvivor(const SortedWorld<View>& world,
                     const typename View::Query& query, Function&& function,
                     Target target = {}) {
  auto call = [&function](Span<const std::uint32_t> ids) {
    if constexpr (std::is_same_v<decltype(function(ids)), bool>) {
      return function(ids);
    } else {
      function(ids);
      return true;
    }
  };
  detail::SortedForEach(
      world.tree(), detail::ValuesOf(query),
      [](void* context, Span<const std::uint32_t> ids) {
        return (*static_cast<decltype(call)*>(context))(ids);
      },
      &call, target);
}

template <typename View>
[[nodiscard]] std::size_t SurvivorsOfEach(
    const SortedWorld<View>& world, Span<const typename View::Query> queries,
    Span<std::uint32_t> ids, Span<std::size_t> offsets, Target target = {}) {
  return detail::SortedSurvivorsOfMany(
      world.tree(),
      queries.size() == 0 ? nullptr : detail::ValuesOf(queries[0]),
      queries.size(), ids, offsets, target);
}

}  // namespace halfspace

#endif  // HALFSPACE_SORTED_H_
