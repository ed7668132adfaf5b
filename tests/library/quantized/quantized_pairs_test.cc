// Every level of an object against every level of a query, in every plane: all
// 65 536 pairs of one byte, and of two bytes all objects against the queries
// where a sign or a byte changes.
//
// Levels are ranks, so they are known: a map is trained from as many values as
// it has thresholds, and then there is one level below them, and one for each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_rows.h"

namespace halfspace::testing {
namespace {

class QuantizedPairsTest : public ::testing::TestWithParam<QuantizedRow> {
 protected:
  // The value that has this level in a plane. In a plane of minima the least
  // level is of what reaches no threshold; in one of maxima the greatest is of
  // what passes all.
  static float ValueOf(std::size_t level) {
    return static_cast<float>(level) - 200.f;
  }

  // Objects that reject nothing but in plane p, where object i has a value of
  // level i.
  std::vector<float> ObjectsOf(std::size_t p) const {
    std::vector<float> values((most_ + 1) * planes_);
    for (std::size_t i = 0; i <= most_; ++i) {
      values[i * planes_ + p] = ValueOf(i);
    }
    return values;
  }

  // Trains from all but the one object that no threshold is for, which is then
  // put in its place.
  std::unique_ptr<AnyQuantized> QuantizedOf(
      std::size_t p, const std::vector<float>& values) const {
    const std::size_t odd = GetParam().IsMinPlane(p) ? 0 : most_;
    std::vector<float> trained = values;
    const auto at =
        trained.begin() + static_cast<std::ptrdiff_t>(odd * planes_);
    trained.erase(at, at + static_cast<std::ptrdiff_t>(planes_));
    auto quantized = GetParam().make(trained);
    quantized->Push(&values[most_ * planes_]);
    for (std::size_t i = 0; i <= most_; ++i) {
      quantized->Set(i, &values[i * planes_]);
    }
    return quantized;
  }

  // Masks alone, for the other outputs are made of them.
  ::testing::AssertionResult RejectsEverywhere(const Answers& answers,
                                               const AnyWorld& quantized,
                                               const AnyQueries& query) {
    mask_.resize(answers.rejected().size());
    for (Target target : TargetsUnderTest()) {
      for (Schedule schedule : kSchedules) {
        const Options options{.schedule = schedule, .target = target};
        detail::RejectMask(quantized.Asked(query), mask_, options);
        Differences compare(options);
        compare.Find<std::uint64_t>("RejectMask", answers.rejected(), mask_);
        if (!compare.first()) return compare.first();
      }
    }
    return ::testing::AssertionSuccess();
  }

  // All of one byte; of two bytes other ones from plane to plane, when not all
  // are tried.
  std::vector<std::uint32_t> QueryLevels(std::size_t p) const {
    std::vector<std::uint32_t> levels;
    if (most_ == 255) {
      for (std::uint32_t level = 0; level <= most_; ++level)
        levels.push_back(level);
      return levels;
    }
    constexpr std::array<std::uint32_t, 16> kEdges = {
        0,     1,     127,   128,   255,   256,   257,   0x7f00,
        32766, 32767, 32768, 32769, 65279, 65280, 65534, 65535};
    for (std::size_t i = 0; i < Scaled(kEdges.size()); ++i) {
      levels.push_back(kEdges[(5 * p + i) % kEdges.size()]);
    }
    return levels;
  }

  const std::size_t planes_ = GetParam().planes();
  const std::size_t most_ =
      (std::size_t{1} << (8 * GetParam().element_bytes)) - 1;

 private:
  std::vector<std::uint64_t> mask_;
};

TEST_P(QuantizedPairsTest, AreComparedAsTheirLevelsAre) {
  for (std::size_t p = 0; p < planes_; ++p) {
    const bool is_min = GetParam().IsMinPlane(p);
    const auto quantized = QuantizedOf(p, ObjectsOf(p));
    std::array<float, 10> query{};
    for (const std::uint32_t level : QueryLevels(p)) {
      query[OpposingValue(GetParam().layout, p)] = ValueOf(level);
      const Answers answers(most_ + 1, [&](std::size_t i) {
        return is_min ? i > level : i < level;
      });
      ASSERT_TRUE(
          RejectsEverywhere(answers, quantized->quantized(), {query.data(), 1}))
          << "plane " << p << ", level " << level << " of the query";
    }
  }
}

// What lies between two thresholds has the level that its side of the test
// gives it: of a minimum that of the threshold below, of a maximum that above.
TEST_P(QuantizedPairsTest, BetweenThresholdsTheNextOneOutwardCounts) {
  constexpr std::uint32_t kLevel = 100;
  const Options options{.target = TargetsUnderTest().front()};
  for (std::size_t p = 0; p < planes_; ++p) {
    SCOPED_TRACE(p);
    const bool is_min = GetParam().IsMinPlane(p);
    const float outward = is_min ? 0.25f : -0.25f;
    auto values = ObjectsOf(p);
    const auto quantized = QuantizedOf(p, values);
    std::array<float, 10> query{};
    const auto survivors = [&](float value) {
      query[OpposingValue(GetParam().layout, p)] = value;
      const AnyWorld world = quantized->quantized();
      return detail::CountSurvivors(world.Asked({query.data(), 1}), options);
    };
    const float value = ValueOf(kLevel);
    const std::size_t count = survivors(value);
    EXPECT_EQ(count, is_min ? kLevel + 1 : most_ + 1 - kLevel);
    EXPECT_EQ(survivors(value + outward), count);
    EXPECT_EQ(survivors(value + 3 * outward), count);
    EXPECT_NE(survivors(value - outward), count);
    values[kLevel * planes_ + p] = value + 3 * outward;
    quantized->Set(kLevel, &values[kLevel * planes_]);
    EXPECT_EQ(survivors(value), count);
    EXPECT_NE(survivors(value - outward), count);
  }
}

// Few numbers among many NaN have a level each.
TEST_P(QuantizedPairsTest, NanTeachesNothing) {
  constexpr std::size_t kNumbers = 100;
  constexpr std::size_t kObjects = 30 * kNumbers;
  for (std::size_t p = 0; p < planes_; ++p) {
    const bool is_min = GetParam().IsMinPlane(p);
    std::vector<float> values(kObjects * planes_);
    for (std::size_t i = 0; i < kObjects; ++i) {
      values[i * planes_ + p] = i % 30 == 0
                                    ? static_cast<float>(i / 30 + 1)
                                    : std::numeric_limits<float>::quiet_NaN();
    }
    const auto quantized = GetParam().make(values);
    std::array<float, 10> query{};
    for (std::size_t n = 0; n <= kNumbers + 1; ++n) {
      query[OpposingValue(GetParam().layout, p)] = static_cast<float>(n);
      const AnyWorld world = quantized->quantized();
      const std::size_t rejected = is_min ? kNumbers - std::min(n, kNumbers)
                                          : n - std::min(n, std::size_t{1});
      EXPECT_EQ(detail::CountSurvivors(world.Asked({query.data(), 1}), {}),
                kObjects - rejected)
          << "plane " << p << ", " << n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, QuantizedPairsTest,
                         ::testing::ValuesIn(QuantizedRows()),
                         QuantizedRowName);

}  // namespace
}  // namespace halfspace::testing
