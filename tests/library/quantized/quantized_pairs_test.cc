// Every level of an object against every level of a query, in every plane: all
// 65 536 pairs of one byte, and of two bytes all objects against the queries
// where a sign or a byte changes.
//
// Levels are ranks, so they are known: a map is trained from as many values as
// it has thresholds, and then there is one level below them, and one for each.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedPairsTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  using Element = typename Case::Element;
  static constexpr std::uint32_t kMost = std::numeric_limits<Element>::max();

  // The value that has this level in a plane. In a plane of minima the least
  // level is of what reaches no threshold; in one of maxima the greatest is of
  // what passes all.
  static float ValueOf(std::uint32_t level) {
    return static_cast<float>(level) - 200.f;
  }

  // Objects that reject nothing but in plane p, where object i has a value of
  // level i.
  static std::vector<Bound> ObjectsOf(std::size_t p) {
    std::vector<Bound> bounds(kMost + std::size_t{1});
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      for (std::size_t other = 0; other < kPlanes<FloatView>; ++other) {
        StoredValue<FloatView>(bounds[i], other) = 0.f;
      }
      StoredValue<FloatView>(bounds[i], p) = ValueOf(static_cast<Element>(i));
    }
    return bounds;
  }

  // Trains from all but the one object that no threshold is for, which is then
  // put in its place.
  static QuantizedBounds<FloatView, Element> QuantizedOf(
      std::size_t p, const std::vector<Bound>& bounds) {
    const std::size_t odd = IsMinPlane<FloatView>(p) ? 0 : kMost;
    std::vector<Bound> trained = bounds;
    trained.erase(trained.begin() + static_cast<std::ptrdiff_t>(odd));
    QuantizedBounds<FloatView, Element> quantized{
        World<FloatView>(trained).view()};
    quantized.Push(bounds.back());
    for (std::size_t i = 0; i < bounds.size(); ++i) quantized.Set(i, bounds[i]);
    return quantized;
  }

  // Masks alone, for the other outputs are made of them.
  ::testing::AssertionResult RejectsEverywhere(
      const Answer& answer,
      const QuantizedBounds<FloatView, Element>& quantized,
      const Query& query) {
    mask_.resize(answer.reject_mask().size());
    for (Target target : targets_) {
      for (Schedule schedule : kSchedules) {
        const Options options{.schedule = schedule, .target = target};
        RejectMask(quantized, query, mask_, options);
        const std::span<const std::uint64_t> mask = mask_;
        if (internal::Same(answer.reject_mask(), mask)) continue;
        return internal::FailElement("RejectMask", options,
                                     answer.reject_mask(), mask);
      }
    }
    return ::testing::AssertionSuccess();
  }

  // All of one byte; of two bytes other ones from plane to plane, when not all
  // are tried.
  static std::vector<std::uint32_t> QueryLevels(std::size_t p) {
    std::vector<std::uint32_t> quantized;
    if (kMost == 255) {
      for (std::uint32_t level = 0; level <= kMost; ++level)
        quantized.push_back(level);
      return quantized;
    }
    constexpr std::array<std::uint32_t, 16> kEdges = {
        0,     1,     127,   128,   255,   256,   257,   0x7f00,
        32766, 32767, 32768, 32769, 65279, 65280, 65534, kMost};
    for (std::size_t i = 0; i < Scaled(kEdges.size()); ++i) {
      quantized.push_back(kEdges[(5 * p + i) % kEdges.size()]);
    }
    return quantized;
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  std::vector<std::uint64_t> mask_;
};

TYPED_TEST_SUITE(QuantizedPairsTest, QuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedPairsTest, AreComparedAsTheirLevelsAre) {
  using View = typename TypeParam::View;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    const bool is_min = IsMinPlane<View>(p);
    const auto bounds = this->ObjectsOf(p);
    const auto quantized = this->QuantizedOf(p, bounds);
    typename View::Query query{};
    for (const std::uint32_t level : this->QueryLevels(p)) {
      OpposingValue<View>(query, p) = this->ValueOf(level);
      const Answer answer(bounds.size(), [&](std::size_t i) {
        return is_min ? i > level : i < level;
      });
      ASSERT_TRUE(this->RejectsEverywhere(answer, quantized, query))
          << "plane " << p << ", level " << level << " of the query";
    }
  }
}

// What lies between two thresholds has the level that its side of the test
// gives it: of a minimum that of the threshold below, of a maximum that above.
TYPED_TEST(QuantizedPairsTest, BetweenThresholdsTheNextOneOutwardCounts) {
  using View = typename TypeParam::View;
  constexpr std::uint32_t kLevel = 100;
  const Options options{.target = TargetsUnderTest().front()};
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    SCOPED_TRACE(p);
    const float outward = IsMinPlane<View>(p) ? 0.25f : -0.25f;
    auto bounds = this->ObjectsOf(p);
    auto quantized = this->QuantizedOf(p, bounds);
    typename View::Query query{};
    const auto survivors = [&](float value) {
      OpposingValue<View>(query, p) = value;
      return CountSurvivors(quantized, query, options);
    };
    const float value = this->ValueOf(kLevel);
    const std::size_t count = survivors(value);
    EXPECT_EQ(count, IsMinPlane<View>(p) ? kLevel + 1 : bounds.size() - kLevel);
    EXPECT_EQ(survivors(value + outward), count);
    EXPECT_EQ(survivors(value + 3 * outward), count);
    EXPECT_NE(survivors(value - outward), count);
    StoredValue<View>(bounds[kLevel], p) = value + 3 * outward;
    quantized.Set(kLevel, bounds[kLevel]);
    EXPECT_EQ(survivors(value), count);
    EXPECT_NE(survivors(value - outward), count);
  }
}

}  // namespace
}  // namespace halfspace::testing
