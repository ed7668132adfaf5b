// One constant per kind of world that stands for all its answers, in every
// form, of one query and of many.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "halfspace/reject_many.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/known_hashes.h"
#include "tests/library/support/quantized_rows.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

constexpr std::size_t kQueries = 32;

// Of all queries, one at a time.
std::uint64_t HashOfEach(const AnyWorld& world, const AnyQueries& queries,
                         const Options& options) {
  std::vector<std::uint64_t> mask(MaskWords(world.size()));
  std::vector<std::uint32_t> indices(world.size());
  FnvHash hash;
  for (std::size_t q = 0; q < queries.count; ++q) {
    const auto asked = [&] { return world.Asked(world.One(queries, q)); };
    detail::RejectMask(asked(), mask, options);
    hash.AddAll(mask);
    detail::SurvivorMask(asked(), mask, options);
    hash.AddAll(mask);
    const std::size_t listed = detail::Survivors(asked(), indices, options, 0);
    hash.AddAll(std::span(indices).first(listed));
    hash.Add(listed);
    hash.Add(detail::CountSurvivors(asked(), options));
    hash.Add(detail::AnySurvivor(asked(), options));
  }
  return hash.value();
}

// Of the calls for many queries. Pairs count by their query, since the tiles
// that they come by may change. Adds the survivors.
std::uint64_t HashOfMany(const AnyWorld& world, const AnyQueries& queries,
                         const Options& options, std::size_t& survivors) {
  std::vector<std::uint64_t> rows(queries.count * MaskWords(world.size()));
  std::vector<std::size_t> counts(queries.count);
  const auto asked = [&] { return world.Asked(queries); };
  FnvHash hash;
  detail::RejectMasks(asked(), rows, options, 0);
  hash.AddAll(rows);
  detail::SurvivorMasks(asked(), rows, options, 0);
  hash.AddAll(rows);
  detail::SurvivorCounts(asked(), counts, options);
  hash.AddAll(counts);
  survivors = std::reduce(counts.begin(), counts.end());
  std::vector<std::uint32_t> by_pair(survivors);
  std::vector<std::uint32_t> objects(survivors);
  hash.Add(detail::SurvivorPairs(asked(), by_pair, objects, options, 0));
  std::vector<std::vector<std::uint32_t>> by_query(queries.count);
  for (std::size_t j = 0; j < survivors; ++j) {
    by_query.at(by_pair[j]).push_back(objects[j]);
  }
  for (const auto& its : by_query) hash.AddAll(its);
  return hash.value();
}

// On every target and schedule. Not all tests may have one answer.
void ExpectKnown(const std::string& name, const AnyWorld& world,
                 const AnyQueries& queries) {
  std::size_t survivors = 0;
  for (Target target : TargetsUnderTest()) {
    for (Schedule schedule : kSchedules) {
      const Options options{.schedule = schedule, .target = target};
      EXPECT_TRUE(IsKnown(name, HashOfEach(world, queries, options)))
          << target.name() << ", schedule " << static_cast<int>(schedule);
      EXPECT_TRUE(IsKnown(name + "Many",
                          HashOfMany(world, queries, options, survivors)))
          << target.name() << ", schedule " << static_cast<int>(schedule);
    }
  }
  const std::size_t tests = world.size() * queries.count;
  EXPECT_GT(survivors, tests / 100);
  EXPECT_LT(survivors, tests - tests / 100);
}

class MaskHashTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  // Half of the values seldom reject, so that some objects survive. The others
  // are anything at all, touch an opposing value or are one ulp from it.
  template <typename T>
  static T Value(SeededNumbers& numbers, T loose, T opposing) {
    const auto bits = std::bit_cast<BitsOf<T>>(opposing);
    switch (numbers.Below(10)) {
      case 0:
        return numbers.Special<T>();
      case 1:
        return numbers.Raw<T>();
      case 2:
        return opposing;
      case 3:
        return std::bit_cast<T>(bits + 1);
      case 4:
        return std::bit_cast<T>(bits - 1);
      default:
        return loose;
    }
  }
};

TEST_P(MaskHashTest, IsTheSameEverywhere) {
  // A tile of a staged scan, then words, then a tail.
  constexpr std::size_t kObjects = 4096 + 3 * 64 + 37;
  const FlatCase& kind = GetParam();
  kind.WithScalar([&]<typename T>(T) {
    SeededNumbers numbers(kind.stored.plane_count);
    std::vector<std::array<T, 10>> stored(kQueries);
    for (auto& query : stored) {
      for (std::size_t p = 0; p < kind.stored.plane_count; ++p) {
        const T loose = p < kind.stored.axes ? 16 : -16;
        query[OpposingValue(kind.stored, p)] = Value<T>(numbers, loose, 0);
      }
    }
    std::vector<std::vector<T>> planes(kind.stored.plane_count);
    PlanePointers pointers{};
    for (std::size_t p = 0; p < planes.size(); ++p) {
      const T loose = p < kind.stored.axes ? -16 : 16;
      for (std::size_t i = 0; i < kObjects; ++i) {
        const auto& query = stored[numbers.Below(kQueries)];
        planes[p].push_back(
            Value<T>(numbers, loose, query[OpposingValue(kind.stored, p)]));
      }
      pointers[p] = planes[p].data();
    }
    std::vector<std::byte> queries(kQueries * kind.query_bytes());
    for (std::size_t q = 0; q < kQueries; ++q) {
      kind.see_query(stored[q].data(), &queries[q * kind.query_bytes()]);
    }
    ExpectKnown(kind.name, kind.world(pointers, kObjects),
                {queries.data(), kQueries});
  });
}

INSTANTIATE_TEST_SUITE_P(, MaskHashTest, ::testing::ValuesIn(AllFlatCases()),
                         FlatCaseName);

class QuantizedHashTest : public ::testing::TestWithParam<QuantizedRow> {};

// Of quantized bounds that are not refined. These are not the answers of the
// floats, but the map is integer arithmetic on the bits of floats.
TEST_P(QuantizedHashTest, IsTheSameEverywhere) {
  // More than a map is trained from, for one byte.
  constexpr std::size_t kObjects = (1 << 16) + 3 * 64 + 37;
  const std::size_t planes = GetParam().planes();
  SeededNumbers numbers(GetParam().layout.dims);
  std::vector<float> values(kObjects * planes);
  for (float& value : values) value = numbers.Coordinate();
  // Values of the objects, of which most survive.
  std::vector<float> queries(kQueries * planes);
  for (std::size_t q = 0; q < kQueries; ++q) {
    for (std::size_t p = 0; p < planes; ++p) {
      const float value = values[numbers.Below(kObjects) * planes + p];
      const float loose = GetParam().IsMinPlane(p) ? 64.f : -64.f;
      queries[q * planes + OpposingValue(GetParam().layout, p)] =
          numbers.Below(3) == 0 ? value : loose;
    }
  }
  const auto all = GetParam().make(values);
  const AnyQueries asked(queries.data(), kQueries);
  for (Target target : TargetsUnderTest()) {
    std::size_t survivors = 0;
    std::size_t exact = 0;
    EXPECT_TRUE(IsKnown(
        GetParam().name,
        HashOfMany(all->quantized(), asked, {.target = target}, survivors)))
        << target.name();
    HashOfMany(all->floats(), asked, {.target = target}, exact);
    EXPECT_GT(survivors, exact);
    EXPECT_GT(exact, kObjects);
    EXPECT_LT(survivors, kObjects * kQueries);
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedHashTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         QuantizedRowName);

}  // namespace
}  // namespace halfspace::testing
