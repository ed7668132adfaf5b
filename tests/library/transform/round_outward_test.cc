// Boxes of doubles as boxes of floats: enclosing, tightest, and the same in
// every floating-point mode of the caller.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/transform.h"
#include "tests/library/support/fp_modes.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

// Special values, those around each float of a few, and any bits.
std::vector<double> SomeDoubles() {
  std::vector<double> values(kSpecialValues<double>.begin(),
                             kSpecialValues<double>.end());
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const bool is_special = i < 20;
    const auto bits = static_cast<std::uint32_t>(random());
    const double value =
        is_special ? kSpecialValues<float>[static_cast<std::size_t>(i)]
                   : std::bit_cast<float>(bits);
    values.insert(values.end(), {value, std::nextafter(value, kInf),
                                 std::nextafter(value, -kInf)});
    values.push_back(std::bit_cast<double>(random()));
  }
  return values;
}

// By the bits alone.
void ExpectTightest(float rounded, double value, bool is_min) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  if (std::isnan(value)) {
    EXPECT_TRUE(std::isnan(rounded));
    return;
  }
  const double sign = is_min ? 1.0 : -1.0;
  const double least = sign * static_cast<double>(rounded);
  EXPECT_FALSE(IsGreater(least, sign * value)) << value;
  if (least == sign * value) return;
  const float next = std::nextafter(rounded, is_min ? kInf : -kInf);
  EXPECT_TRUE(IsGreater(sign * static_cast<double>(next), sign * value))
      << value;
}

template <typename Bound>
class RoundOutwardTest : public ::testing::Test {};
#if defined(HALFSPACE_TEST_ONLY_3D)
using DoubleBoxes = ::testing::Types<Aabb<3, double>>;
#else
using DoubleBoxes =
    ::testing::Types<Aabb<2, double>, Aabb<3, double>, Aabb<4, double>>;
#endif
TYPED_TEST_SUITE(RoundOutwardTest, DoubleBoxes);

// All values, one after another on the planes.
template <typename Bound>
std::vector<Bound> SomeBounds() {
  std::vector<Bound> bounds;
  detail::PlaneValues<Bound> planes;
  const std::vector<double> values = SomeDoubles();
  for (std::size_t i = 0; i < values.size() * planes.size(); ++i) {
    // Each value is on each plane once.
    const std::size_t p = i % planes.size();
    planes[p] = values[(i / planes.size() + 7 * p) % values.size()];
    if (p + 1 == planes.size()) {
      bounds.push_back(detail::BoundOf<Bound>(planes));
    }
  }
  return bounds;
}

TYPED_TEST(RoundOutwardTest, EnclosesAndIsTightest) {
  for (const TypeParam& bound : SomeBounds<TypeParam>()) {
    const auto values = detail::Planes(bound);
    const auto rounded = detail::Planes(RoundOutward(bound));
    for (std::size_t p = 0; p < values.size(); ++p) {
      ExpectTightest(rounded[p], values[p], p < TypeParam::kAxes);
    }
  }
}

TYPED_TEST(RoundOutwardTest, IsTheSameInEveryMode) {
  for (const TypeParam& bound : SomeBounds<TypeParam>()) {
    const auto bits_in_mode = [&] {
      return std::bit_cast<
          std::array<std::uint32_t, detail::kPlaneCount<TypeParam>>>(
          detail::Planes(RoundOutward(bound)));
    };
    const auto expected = bits_in_mode();
    for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
      const RoundingMode rounding(mode);
      EXPECT_EQ(bits_in_mode(), expected);
    }
    {
      const FlushDenormals flush;
      EXPECT_EQ(bits_in_mode(), expected);
    }
    const TrapExceptions traps;
    const auto trapped = bits_in_mode();
    EXPECT_TRUE(traps.IsUntouched());
    EXPECT_EQ(trapped, expected);
  }
}

TYPED_TEST(RoundOutwardTest, EmptyStaysEmpty) {
  const auto empty = RoundOutward(TypeParam::Empty());
  EXPECT_EQ(empty, decltype(empty)::Empty());
  // What engines initialise boxes to.
  auto untouched = detail::Planes(TypeParam::Empty());
  for (double& value : untouched) {
    value = std::copysign(std::numeric_limits<double>::max(), value);
  }
  EXPECT_TRUE(IsEmpty(RoundOutward(detail::BoundOf<TypeParam>(untouched))));
}

}  // namespace
}  // namespace halfspace::testing
