// What a sorted world should answer: a list of its objects, and a scan of it.
#ifndef HALFSPACE_TESTS_LIBRARY_SORTED_MODEL_H_
#define HALFSPACE_TESTS_LIBRARY_SORTED_MODEL_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/sorted/spread.h"

namespace halfspace::testing {

// What a world should have: the bound and the categories of each id.
template <typename View>
struct Model {
  struct Object {
    typename View::Bound bound;
    std::uint32_t categories = 0xFFFFFFFF;
  };
  std::map<std::uint32_t, Object> objects;

  Ids Expected(const typename View::Query& query,
               std::uint32_t categories) const {
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
      if (~categories == 0 || (object.categories & categories) != 0) {
        expected.push_back(of_world[i]);
      }
    }
    return expected;
  }
};

template <typename View>
void ExpectIsModel(const SortedWorld<View>& sorted, const Model<View>& model,
                   std::span<const typename View::Query> queries, Target target,
                   std::uint32_t categories = 0xFFFFFFFF) {
  ASSERT_EQ(sorted.size(), model.objects.size());
  const SortedOptions options = {.categories = categories, .target = target};
  for (const auto& query : queries) {
    const Ids expected = model.Expected(query, categories);
    Ids ids(sorted.size());
    ASSERT_EQ(Survivors(sorted, query, ids, options), expected.size());
    ids.resize(expected.size());
    ASSERT_EQ(Sorted(ids), expected);
    ASSERT_EQ(CountSurvivors(sorted, query, options), expected.size());
    ASSERT_EQ(AnySurvivor(sorted, query, options).has_value(),
              !expected.empty());
  }
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

#endif  // HALFSPACE_TESTS_LIBRARY_SORTED_MODEL_H_
