// The map from floats to levels: monotone on both sides of a test, the same on
// both, and NaN where it never rejects.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "halfspace/detail/quantized.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/special_values.h"

namespace halfspace::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// One plane of minima, then one of maxima: a box of one dimension.
template <typename Stored>
class QuantizedMapTest : public ::testing::Test {
 protected:
  // Ascending and of every kind, without NaN.
  std::vector<float> BvhValues() {
    std::vector<float> values;
    for (const float value : kSpecialValues<float>) {
      if (value == value) values.push_back(value);
    }
    for (std::size_t i = 0; i < Scaled(3000); ++i) {
      const auto bits = static_cast<std::uint32_t>(random_());
      const float any = std::bit_cast<float>(bits);
      if (any == any) values.push_back(any);
      values.push_back(
          std::uniform_real_distribution<float>(-9.f, 9.f)(random_));
      values.push_back(std::bit_cast<float>(bits & 0x80ffffffu));
    }
    std::stable_sort(values.begin(), values.end());
    return values;
  }

  void Train(const std::vector<float>& values) {
    auto columns = detail::ColumnsOf<float>(values.size(), 1);
    columns.column[0] = columns.column[1] = values.data();
    quantizer_ =
        quantizer_.Trained(columns, std::size_t{1} << (8 * sizeof(Stored)));
  }

  // Ranks: how many thresholds a value stands for.
  std::uint32_t OfObject(std::size_t p, float value) const {
    Stored level{};
    quantizer_.EncodeObjects(p, &value, 1, 1, &level);
    return quantizer_.RankOf(p, level);
  }

  // Of a query's minimum, which meets maxima, then of its maximum.
  std::array<std::uint32_t, 2> OfQuery(float min, float max) const {
    const std::array<float, 2> values = {min, max};
    std::array<Stored, 2> levels{};
    quantizer_.EncodeQuery(values.data(), levels.data());
    return {quantizer_.RankOf(1, levels[0]), quantizer_.RankOf(0, levels[1])};
  }

  Random random_{47};
  detail::Quantizer quantizer_{{1, 1, true}, MemoryResource()};
};

using StoredTypes = ::testing::Types<std::int8_t, std::int16_t>;
struct StoredNames {
  template <typename Stored>
  static std::string GetName(int) {
    return "Uint" + std::to_string(8 * sizeof(Stored));
  }
};
TYPED_TEST_SUITE(QuantizedMapTest, StoredTypes, StoredNames);

TYPED_TEST(QuantizedMapTest, IsMonotoneAndTheSameOnBothSides) {
  const std::vector<float> values = this->BvhValues();
  for (std::size_t trained : {0u, 1u, 2u, 3u, 100u, 254u, 255u, 256u, 3000u}) {
    std::vector<float> some(std::min(trained, values.size()));
    for (float& value : some) value = values[this->random_() % values.size()];
    this->Train(some);
    std::array<std::uint32_t, 2> last = {};
    for (const float value : values) {
      const std::array objects = {this->OfObject(0, value),
                                  this->OfObject(1, value)};
      // A stored minimum meets a query's maximum.
      const auto query = this->OfQuery(value, value);
      ASSERT_EQ(objects[0], query[1]) << value << ", " << trained;
      ASSERT_EQ(objects[1], query[0]) << value << ", " << trained;
      ASSERT_GE(objects[0], last[0]) << value << ", " << trained;
      ASSERT_GE(objects[1], last[1]) << value << ", " << trained;
      last = objects;
    }
  }
}

// What the kernels rely on: in every plane the lesser stored level rejects.
TYPED_TEST(QuantizedMapTest, MinimaAreStoredInReverse) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  this->Train(this->BvhValues());
  std::array<TypeParam, 2> low{};
  std::array<TypeParam, 2> high{};
  this->quantizer_.EncodeObject(std::array{-kInfinity, -kInfinity}.data(),
                                low.data());
  this->quantizer_.EncodeObject(std::array{kInfinity, kInfinity}.data(),
                                high.data());
  EXPECT_GT(low[0], high[0]);
  EXPECT_LT(low[1], high[1]);
}

TYPED_TEST(QuantizedMapTest, NanNeverRejects) {
  const std::vector<float> values = this->BvhValues();
  this->Train(values);
  for (const float nan : kSpecialValues<float>) {
    if (nan == nan) continue;
    EXPECT_EQ(this->OfObject(0, nan), 0u);
    EXPECT_GE(this->OfObject(1, nan), this->OfObject(1, values.back()));
    const auto query = this->OfQuery(nan, nan);
    EXPECT_EQ(query[0], 0u);
    EXPECT_GE(query[1], this->OfObject(0, values.back()));
  }
}

// What one mode of the processor takes for zero is zero in all.
TYPED_TEST(QuantizedMapTest, SubnormalsAreZero) {
  this->Train(this->BvhValues());
  for (const std::uint32_t bits :
       {0x80000000u, 1u, 0x80000001u, 0x007fffffu, 0x807fffffu}) {
    const float value = std::bit_cast<float>(bits);
    for (std::size_t p : {0u, 1u}) {
      EXPECT_EQ(this->OfObject(p, value), this->OfObject(p, 0.f)) << bits;
    }
    EXPECT_EQ(this->OfQuery(value, value), this->OfQuery(0.f, 0.f)) << bits;
  }
}

// Planes without a number teach nothing, and no NaN is a threshold.
TYPED_TEST(QuantizedMapTest, NanTeachesNothing) {
  this->Train(std::vector<float>(300, kNan));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t p : {0u, 1u}) {
    EXPECT_EQ(this->OfObject(p, -kInfinity), this->OfObject(p, kInfinity));
  }
  // Few among many, and each gets a level of its own.
  std::vector<float> values(3000, kNan);
  for (std::size_t i = 0; i < 100; ++i) {
    values[30 * i] = static_cast<float>(i + 1);
  }
  this->Train(values);
  EXPECT_EQ(this->OfObject(0, 0.f), 0u);
  EXPECT_EQ(this->OfObject(0, 1.f), 1u);
  EXPECT_EQ(this->OfObject(0, 2.f), 2u);
  EXPECT_EQ(this->OfObject(1, 1.f), 0u);
  EXPECT_EQ(this->OfObject(1, 2.f), 1u);
  EXPECT_EQ(this->OfObject(1, 3.f), 2u);
}

// Every lane of the search, and what is left of eight.
TYPED_TEST(QuantizedMapTest, ManyAreEncodedAsOneIs) {
  this->Train(this->BvhValues());
  std::vector<float> values = this->BvhValues();
  std::shuffle(values.begin(), values.end(), this->random_);
  for (std::size_t count = 0; count <= 40; ++count) {
    for (std::size_t p : {0u, 1u}) {
      std::vector<TypeParam> levels(count + 1, TypeParam{77});
      this->quantizer_.EncodeObjects(p, values.data(), 1, count, levels.data());
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(this->quantizer_.RankOf(p, levels[i]),
                  this->OfObject(p, values[i]))
            << count << ", " << i;
      }
      ASSERT_EQ(levels[count], TypeParam{77}) << count;
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
