// Hashes of the answers of quantized bounds that are not refined. They are not
// the answers of the floats, but the map is integer arithmetic on the bits of
// floats, so they are the same on every machine, target and compiler.
//
// HALFSPACE_TEST_SCALE does not count here. If the map is meant to change, the
// message of the failed test has the new constant.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <ios>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/quantized_cases.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

const std::map<std::string, std::uint64_t> kExpected = {
    {"Aabb2Uint16", 0x77335c127c9add85},
    {"Aabb2Uint8", 0x84b16391702f649f},
    {"Aabb3Uint16", 0xaca5c8fa1d854cc8},
    {"Aabb3Uint8", 0x4e23039cb375b8fc},
    {"Aabb4Uint16", 0xf1a9dd089cfc8816},
    {"Aabb4Uint8", 0x17a292f1414a3156},
    {"Aabo2Uint16", 0xd5aa72ccea32c180},
    {"Aabo2Uint8", 0xa1c2d6e57e24bb47},
    {"Aabo3Uint16", 0x4dd5804220ac50cd},
    {"Aabo3Uint8", 0xe889b4fb5c5d905c},
    {"Aabo4Uint16", 0xc5fd14c35c5d322f},
    {"Aabo4Uint8", 0x6052437b97610fcf},
    {"Simplex2Uint16", 0x2e05b0496f11cc82},
    {"Simplex2Uint8", 0x8b85b58b8612e2e5},
    {"Simplex3Uint16", 0xf961fe6d69e85406},
    {"Simplex3Uint8", 0x88e4c6cc31fc1bb3},
    {"Simplex4Uint16", 0x804f24833494df68},
    {"Simplex4Uint8", 0xcb834005e9d51547},
};

template <typename Case>
class QuantizedHashTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using TheWorld = QuantizedWorld<FloatView, typename Case::Element>;
  // More than a map is trained from, for one byte.
  static constexpr std::size_t kObjects = (1 << 16) + 3 * 64 + 37;
  static constexpr std::size_t kQueries = 32;

  QuantizedHashTest() {
    SeededNumbers numbers(FloatView::Bound::kDimensions);
    std::vector<typename FloatView::Bound> bounds(kObjects);
    for (auto& bound : bounds) {
      for (std::size_t p = 0; p < kPlanes<FloatView>; ++p) {
        StoredValue<FloatView>(bound, p) = numbers.Coordinate();
      }
    }
    floats_.Assign(bounds);
    world_ = TheWorld(floats_);
    // Values of the objects, of which most survive.
    for (auto& query : queries_) {
      for (std::size_t p = 0; p < kPlanes<FloatView>; ++p) {
        auto& other = bounds[numbers.Below(kObjects)];
        const float value = StoredValue<FloatView>(other, p);
        const float loose = IsMinPlane<FloatView>(p) ? 64.f : -64.f;
        OpposingValue<FloatView>(query, p) =
            numbers.Below(3) == 0 ? value : loose;
      }
    }
  }

  std::uint64_t HashOf(const Options& options) {
    std::vector<std::uint64_t> mask(MaskWords(kObjects));
    FnvHash hash;
    survivors_ = 0;
    exact_ = 0;
    for (const auto& query : queries_) {
      SurvivorMask(world_.quantized(), query, mask, options);
      hash.AddAll(mask);
      survivors_ += CountSurvivors(world_.quantized(), query, options);
      exact_ += CountSurvivors(floats_, query, options);
    }
    return hash.value();
  }

  // Answers of the floats would say nothing about the map.
  void ExpectItsOwnAnswers() const {
    EXPECT_GT(survivors_, exact_);
    EXPECT_GT(exact_, kObjects);
    EXPECT_LT(survivors_, kObjects * kQueries);
  }

 private:
  World<FloatView> floats_;
  TheWorld world_;
  std::array<typename FloatView::Query, kQueries> queries_;
  std::size_t survivors_ = 0;
  std::size_t exact_ = 0;
};

TYPED_TEST_SUITE(QuantizedHashTest, QuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedHashTest, IsTheSameEverywhere) {
  const std::string name = QuantizedCaseNames::GetName<TypeParam>(0);
  const std::uint64_t expected = kExpected.at(name);
  for (Target target : TargetsUnderTest()) {
    const std::uint64_t hash = this->HashOf({.target = target});
    EXPECT_EQ(hash, expected) << target.name() << ": the hash of " << name
                              << " is 0x" << std::hex << hash;
  }
  this->ExpectItsOwnAnswers();
}

}  // namespace
}  // namespace halfspace::testing
