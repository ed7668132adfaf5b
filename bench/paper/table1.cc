// Table 1 of "The Bounding Simplex: A SIMD-Era Rejection Primitive", and the
// same count for objects in the orders that the paper names and defers.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/paper/work_count.h"
#include "bench/sections/run.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kBatch = 64;

// How objects are sorted: by medians of their centers, until no part has more
// than a batch.
struct Order {
  const char* name;
  bool is_sorted;
  bool is_rotating;    // X, Y, Z and again; otherwise the axis of widest spread
  bool is_by_batches;  // splits at multiples of a batch; otherwise in half
};
constexpr std::array<Order, 4> kOrders = {
    {{"as made", false, false, false},
     {"rotating axes", true, true, false},
     {"rotating axes, whole batches", true, true, true},
     {"widest axis, whole batches", true, false, true}}};

using Center = std::array<float, 3>;

std::size_t WidestAxis(std::span<const std::uint32_t> ids,
                       const std::vector<Center>& centers) {
  std::array<float, 3> spreads{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [least, most] = std::minmax_element(
        ids.begin(), ids.end(), [&](std::uint32_t a, std::uint32_t b) {
          return centers[a][k] < centers[b][k];
        });
    spreads[k] = centers[*most][k] - centers[*least][k];
  }
  return static_cast<std::size_t>(
      std::max_element(spreads.begin(), spreads.end()) - spreads.begin());
}

void SortBy(const Order& order, const std::vector<Center>& centers,
            std::size_t depth, std::span<std::uint32_t> ids) {
  if (ids.size() <= kBatch) return;
  std::size_t middle = ids.size() / 2;
  if (order.is_by_batches) middle = (middle + kBatch - 1) / kBatch * kBatch;
  const std::size_t axis =
      order.is_rotating ? depth % 3 : WidestAxis(ids, centers);
  std::nth_element(ids.begin(),
                   ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return centers[a][axis] < centers[b][axis];
                   });
  SortBy(order, centers, depth + 1, ids.first(middle));
  SortBy(order, centers, depth + 1, ids.subspan(middle));
}

AaboWorld3 InOrder(const Order& order, const AaboWorld3& world) {
  std::vector<Center> centers(world.size());
  for (std::size_t i = 0; i < world.size(); ++i) {
    const Aabo3 object = world.Get(i);
    for (std::size_t k = 0; k < 3; ++k) {
      centers[i][k] = object.min[k] + (object.max[k] - object.min[k]) / 2;
    }
  }
  std::vector<std::uint32_t> ids(world.size());
  std::iota(ids.begin(), ids.end(), 0u);
  if (order.is_sorted) SortBy(order, centers, 0, ids);
  AaboWorld3 sorted;
  for (std::uint32_t id : ids) sorted.Push(world.Get(id));
  return sorted;
}

Table OrdersTable(const Workload& workload) {
  // No power of two, which halves would split into whole batches.
  constexpr std::size_t kMostObjects = 100'000;
  const AaboWorld3 world = Thinned(workload.objects, kMostObjects);
  Table table{"table1: sorted objects",
              "half-spaces evaluated per object in batches of 64, by the order "
              "of objects, counted",
              {Key("order"), Value("AABB", "", 3), Value("simplex", "", 3),
               Value("AABO", "", 3), Value("batches left", "%", 3)}};
  for (const Order& order : kOrders) {
    const AaboWorld3 sorted = InOrder(order, world);
    WorkCounter counter(sorted.view());
    std::vector<std::uint64_t> mask(MaskWords(sorted.size()));
    std::size_t left = 0;
    for (const Aabo3& query : workload.queries) {
      counter.Add(query);
      SurvivorMask(sorted.view().aabb(), query.aabb(), mask);
      left += BatchesLeft(mask, kBatch);
    }
    const WorkCount work = counter.Average();
    constexpr std::size_t kAt = 3;
    static_assert(kWorkWidths[kAt] == kBatch);
    table.Add({order.name, work.aabb[kAt], work.simplex[kAt], work.aabo[kAt],
               100.0 * static_cast<double>(left) /
                   static_cast<double>(mask.size() * workload.queries.size())});
  }
  table.notes = {Grouped(world.size()) + " objects of " + workload.name + ", " +
                 Grouped(workload.queries.size()) +
                 " queries. Sorted by medians of the centers. whole batches: a "
                 "split is at a multiple of 64 objects. batches left: that "
                 "have a survivor of the AABB."};
  return table;
}

}  // namespace

Tables RunTable1(Run& run) {
  const Workload& scene = run.Scene();
  WorkCounter counter(scene.objects.view());
  for (const Aabo3& query : scene.queries) counter.Add(query);
  const WorkCount work = counter.Average();
  Table table{"table1",
              "half-spaces evaluated per object in batches of w, counted",
              {Key("w")}};
  std::string survivors;
  for (ShapeKind shape : kShapes) {
    table.columns.push_back(Value(NameOf(shape)));
    table.columns.push_back(Value("paper"));
    survivors += std::string(NameOf(shape)) + " " +
                 Grouped(counter.survivors().Of(shape)) + " (paper " +
                 Grouped(kPaperSurvivors.Of(shape)) + "), ";
  }
  for (std::size_t i = 0; i < kWorkWidths.size(); ++i) {
    Row row = {kWorkWidths[i]};
    for (ShapeKind shape : kShapes) {
      row.emplace_back(work.Of(shape)[i]);
      row.emplace_back(kPaperWork.Of(shape)[i]);
    }
    table.Add(std::move(row));
  }
  table.notes.push_back(Grouped(scene.objects.size()) + " objects, " +
                        Grouped(scene.queries.size()) +
                        " queries. Survivors: " + survivors +
                        "another seed in the paper.");
  return {table, OrdersTable(run.Measured())};
}

}  // namespace halfspace::bench
