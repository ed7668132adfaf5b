// Quantized bounds are worth their memory: how much more than floats they keep,
// and whether they know when they have become worse. All counts are of seeded
// scenes, and the same on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedQualityTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Element = typename Case::Element;
  using Bound = typename FloatView::Bound;
  using Query = typename FloatView::Query;
  static constexpr bool kIsByte = sizeof(Element) == 1;

  // 0 ... 1, in steps of 2^-24.
  static float Fraction(SeededNumbers& numbers) {
    return static_cast<float>(numbers.Below(1 << 24)) * 0x1p-24f;
  }

  // An interval of up to `size` on every axis, somewhere between 0 and 100.
  Bound RandomBound(float size) {
    Bound bound;
    for (std::size_t p = 0; p < kMinima<FloatView>; ++p) {
      StoredValue<FloatView>(bound, p) = 100.f * Fraction(numbers_);
    }
    for (std::size_t p = kMinima<FloatView>; p < kPlanes<FloatView>; ++p) {
      StoredValue<FloatView>(bound, p) =
          StoredValue<FloatView>(bound, p - kMinima<FloatView>) +
          size * Fraction(numbers_);
    }
    return bound;
  }

  std::vector<Bound> RandomBounds(std::size_t count) {
    std::vector<Bound> bounds(count);
    for (Bound& bound : bounds) bound = RandomBound(20.f);
    return bounds;
  }

  // Of the same kind, but rejecting about as many of the objects in each shape.
  Query RandomQuery() {
    Query query;
    for (std::size_t p = 0; p < kMinima<FloatView>; ++p) {
      const float from = 100.f * Fraction(numbers_);
      OpposingValue<FloatView>(query, p) = from + 20.f;
      if constexpr (HasMaxima<FloatView>) {
        OpposingValue<FloatView>(query, p + kMinima<FloatView>) = from;
      }
    }
    return query;
  }

  // Survivors of the quantized bounds, as a multiple of those of the floats.
  double Excess(const std::vector<Bound>& bounds) {
    const World<FloatView> floats(bounds);
    const QuantizedBounds<FloatView, Element> quantized(floats.view());
    std::size_t exact = 0;
    std::size_t of_quantized = 0;
    for (int i = 0; i < 64; ++i) {
      const Query query = RandomQuery();
      exact += CountSurvivors(floats, query);
      of_quantized += CountSurvivors(quantized, query);
    }
    EXPECT_GT(exact, 100u);
    return static_cast<double>(of_quantized) / static_cast<double>(exact);
  }

  SeededNumbers numbers_{41};
};

TYPED_TEST_SUITE(QuantizedQualityTest, FewQuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedQualityTest, FewMoreSurviveThanOfFloats) {
  const auto bounds = this->RandomBounds(50'000);
  const double excess = this->Excess(bounds);
  EXPECT_GE(excess, 1.0);
  EXPECT_LE(excess, TestFixture::kIsByte ? 1.6 : 1.02);
}

// The objects come in order of an axis, and are more than a map is trained
// from: all of them must count, not the first only. Just below the size at
// which every second object is looked at.
TYPED_TEST(QuantizedQualityTest, OrderedObjectsAreToldApartToo) {
  const std::size_t sampled = TestFixture::kIsByte ? 1 << 16 : 1 << 18;
  auto bounds = this->RandomBounds(2 * sampled - 1);
  std::sort(bounds.begin(), bounds.end(),
            [](const auto& a, const auto& b) { return a.min[0] < b.min[0]; });
  EXPECT_LE(this->Excess(bounds), TestFixture::kIsByte ? 1.6 : 1.02);
}

// Outliers take no levels from the others.
TYPED_TEST(QuantizedQualityTest, OutliersCostNothing) {
  using View = typename TypeParam::View;
  auto bounds = this->RandomBounds(50'000);
  for (std::size_t i = 0; i < bounds.size(); i += 1000) {
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      StoredValue<View>(bounds[i], p) = i % 2000 == 0 ? 1e30f : -1e30f;
    }
  }
  EXPECT_LE(this->Excess(bounds), TestFixture::kIsByte ? 1.6 : 1.02);
}

// A query beyond all objects rejects all of them, however many objects there
// are for a threshold.
TYPED_TEST(QuantizedQualityTest, QueriesBeyondAllRejectAll) {
  using View = typename TypeParam::View;
  for (const std::size_t size : {1u, 2u, 100u, 255u, 256u, 1000u, 70'000u}) {
    auto bounds = this->RandomBounds(size);
    const QuantizedWorld<View, typename TypeParam::Element> world{
        std::span(std::as_const(bounds))};
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      const bool is_min = IsMinPlane<View>(p);
      float extreme = StoredValue<View>(bounds[0], p);
      for (auto& bound : bounds) {
        const float value = StoredValue<View>(bound, p);
        extreme = is_min ? std::min(extreme, value) : std::max(extreme, value);
      }
      auto query = View::Query::Everything();
      OpposingValue<View>(query, p) = extreme;
      EXPECT_TRUE(AnySurvivor(world.quantized(), query)) << size << ", " << p;
      OpposingValue<View>(query, p) = extreme + (is_min ? -1.f : 1.f);
      // Only what is among the samples is sure to be a threshold.
      if (size > (1u << 16)) continue;
      EXPECT_FALSE(AnySurvivor(world.quantized(), query)) << size << ", " << p;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
