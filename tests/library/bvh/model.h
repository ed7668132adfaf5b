// What a BVH should answer: a list of its objects, and a scan of it.
#ifndef HALFSPACE_TESTS_LIBRARY_BVH_MODEL_H_
#define HALFSPACE_TESTS_LIBRARY_BVH_MODEL_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/bvh/spread.h"

namespace halfspace::testing {

// What a world should have: the bound and the masks of each id.
template <typename View>
struct Model {
  struct Object {
    typename View::Bound bound;
    std::uint32_t masks = 0xFFFFFFFF;
  };
  std::map<std::uint32_t, Object> objects;

  Ids Expected(const typename View::Query& query, std::uint32_t masks) const {
    World<View> world;
    Ids of_world;
    for (const auto& [id, object] : objects) {
      world.Push(object.bound);
      of_world.push_back(id);
    }
    Ids ids(world.size());
    ids.resize(Survivors(world, query, ids));
    Ids expected;
    for (std::uint32_t i : ids) {
      const Object& object = objects.at(of_world[i]);
      if (~masks == 0 || (object.masks & masks) != 0) {
        expected.push_back(of_world[i]);
      }
    }
    return expected;
  }
};

template <typename View>
void ExpectIsModel(const Bvh<View>& bvh, const Model<View>& model,
                   std::span<const typename View::Query> queries, Target target,
                   std::uint32_t masks = 0xFFFFFFFF) {
  ASSERT_EQ(bvh.size(), model.objects.size());
  const QueryOptions options = {.mask = masks, .target = target};
  std::vector<std::size_t> expected_counts;
  for (const auto& query : queries) {
    const Ids expected = model.Expected(query, masks);
    Ids ids(bvh.size());
    ASSERT_EQ(Survivors(bvh, query, ids, options), expected.size());
    ids.resize(expected.size());
    ASSERT_EQ(InOrder(ids), expected);
    ASSERT_EQ(CountSurvivors(bvh, query, options), expected.size());
    expected_counts.push_back(expected.size());
    ASSERT_EQ(AnySurvivor(bvh, query, options).has_value(), !expected.empty());
  }
  std::vector<std::size_t> counts(queries.size(), 99);
  CountSurvivorsOfEach(bvh, queries, counts, options);
  ASSERT_EQ(counts, expected_counts);
}

// Queries small and large, and one around everything, where empty slots and
// nodes that are counted without a visit would show.
template <typename View>
std::vector<typename View::Query> SomeQueries(std::uint64_t seed) {
  std::vector<typename View::Query> queries = {View::Query::Everything()};
  for (float radius : {1.0f, 8.0f, 35.0f, 200.0f}) {
    queries.push_back(Spread<View>(radius, seed).NextQuery());
  }
  return queries;
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_BVH_MODEL_H_
