// The five calls for many queries as a list, for what must hold for each.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_CALLS_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_CALLS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>

#include "halfspace/reject_many.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/canaries.h"

namespace halfspace::testing {

// Room for the rows and lists of small worlds and few queries, and proof that
// nothing was written there and no tile was seen.
struct ManyCallOutputs {
  static constexpr std::size_t kRoom = 300;

  Canaried<std::uint64_t> rows;
  Canaried<std::uint32_t> query_indices;
  Canaried<std::uint32_t> object_indices;
  Canaried<std::size_t> counts;
  std::size_t tiles = 0;

  bool Untouched() const {
    return rows.IntactBut(0) && query_indices.IntactBut(0) &&
           object_indices.IntactBut(0) && counts.IntactBut(0) && tiles == 0;
  }
};

// Calls visit(name, call) for each of the five.
template <typename AnyWorld, typename Visit>
void ForEachManyCall(const AnyWorld& world,
                     std::span<const typename AnyWorld::Query> queries,
                     const Options& options, ManyCallOutputs& outputs,
                     Visit visit) {
  constexpr std::size_t kRoom = ManyCallOutputs::kRoom;
  const auto rows = outputs.rows.Reset(kRoom);
  const auto query_indices = outputs.query_indices.Reset(kRoom);
  const auto object_indices = outputs.object_indices.Reset(kRoom);
  const auto counts = outputs.counts.Reset(kRoom);
  outputs.tiles = 0;
  visit("RejectMasks", [&] { RejectMasks(world, queries, rows, options); });
  visit("SurvivorMasks", [&] { SurvivorMasks(world, queries, rows, options); });
  visit("SurvivorPairs", [&] {
    std::ignore =
        SurvivorPairs(world, queries, query_indices, object_indices, options);
  });
  visit("SurvivorCounts",
        [&] { SurvivorCounts(world, queries, counts, options); });
  visit("ForEachTile", [&] {
    ForEachTile(
        world, queries, [&](const SurvivorTile&) { ++outputs.tiles; }, options);
  });
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_MANY_CALLS_H_
