// What the builders promise besides rounding: statuses, special values, layout
// and errors.
#include "halfspace/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/library/support/dims.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/points.h"

namespace halfspace::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Calls, how many of them gave Everything(), and which was the first of those.
using Counts = std::array<std::size_t, 3>;
Counts CountsOf(const FitStatus& status) {
  return {status.results, status.everything, status.first_everything};
}

template <typename Dims>
class FitTest : public ::testing::Test {
 protected:
  using ABound = Aabo<Dims::value>;
  using ABox = Aabb<Dims::value>;

  static ABound Bound(const std::vector<float>& coords,
                      FitStatus* status = nullptr) {
    return BoundPoints<Dims::value>(
        {coords.data(), coords.size() / Dims::value}, status);
  }

  // A box from 0 to 1, with other values where a test puts them.
  static ABox UnitBox() {
    ABox box;
    box.min.fill(0.f);
    box.max.fill(1.f);
    return box;
  }
};
TYPED_TEST_SUITE(FitTest, AllDims, DimsNames);

TYPED_TEST(FitTest, NothingGivesEmpty) {
  constexpr int kDims = TypeParam::value;
  FitStatus status;
  EXPECT_EQ(BoundPoints<kDims>({nullptr, 0}, &status), Aabo<kDims>::Empty());
  EXPECT_EQ(BoundAabb(Aabb<kDims>::Empty(), &status), Aabo<kDims>::Empty());
  EXPECT_EQ(CountsOf(status), (Counts{2, 0, 0}));
}

// In every coordinate of every point.
TYPED_TEST(FitTest, PointThatCannotBeBoundedGivesEverything) {
  constexpr int kDims = TypeParam::value;
  const float too_large = std::nextafter(0x1p125f, kInfinity);
  for (float bad : {kNan, -kNan, kInfinity, -kInfinity, too_large, -too_large,
                    detail::kMax<float>, -detail::kMax<float>}) {
    for (std::size_t at = 0; at < 3 * kDims; ++at) {
      std::vector<float> coords(3 * kDims, 1.f);
      coords[at] = bad;
      FitStatus status;
      EXPECT_EQ(this->Bound(coords, &status), Aabo<kDims>::Everything())
          << bad << " at " << at;
      EXPECT_EQ(CountsOf(status), (Counts{1, 1, 0}));
    }
  }
}

// The naive sum of 2e38, 2e38 and -3e38 overflows, or is a NaN.
TYPED_TEST(FitTest, SumOfMagnitudesIsWhatIsLimited) {
  constexpr int kDims = TypeParam::value;
  std::vector<float> coords(kDims, 0.f);
  coords[0] = 0x1p124f;
  coords[1] = -0x1p124f;
  const Aabo<kDims> bound = this->Bound(coords);
  EXPECT_EQ(bound.min[kDims], 0.f);
  EXPECT_EQ(bound.max[kDims], 0.f);
  // Two ulps: the sum is taken in the precision of the input, and rounds.
  coords[1] = -0x1.000004p124f;
  EXPECT_EQ(this->Bound(coords), Aabo<kDims>::Everything());
  coords[0] = 2e38f;
  coords[1] = -2e38f;
  EXPECT_EQ(this->Bound(coords), Aabo<kDims>::Everything());
}

TYPED_TEST(FitTest, BoxThatCannotBeBoundedGivesEverything) {
  constexpr int kDims = TypeParam::value;
  for (int k = 0; k < kDims; ++k) {
    for (float bad : {kNan, kInfinity, detail::kMax<float>, 0x1.000002p125f}) {
      auto box = this->UnitBox();
      box.max[k] = bad;
      FitStatus status;
      EXPECT_EQ(BoundAabb(box, &status), Aabo<kDims>::Everything()) << bad;
      box = this->UnitBox();
      box.min[k] = -bad;
      EXPECT_EQ(BoundAabb(box, &status), Aabo<kDims>::Everything()) << bad;
      EXPECT_EQ(CountsOf(status), (Counts{2, 2, 0}));
    }
  }
  EXPECT_EQ(BoundAabb(Aabb<kDims>::Everything()), Aabo<kDims>::Everything());
}

TYPED_TEST(FitTest, StatusCountsCallsAndNamesTheFirst) {
  constexpr int kDims = TypeParam::value;
  const std::vector<float> good(kDims, 1.f);
  const std::vector<float> bad(kDims, kNan);
  FitStatus status;
  this->Bound(good, &status);
  BoundAabb(this->UnitBox(), &status);
  EXPECT_EQ(CountsOf(status), (Counts{2, 0, 0}));
  this->Bound(bad, &status);
  this->Bound(good, &status);
  BoundAabb(Aabb<kDims>::Everything(), &status);
  EXPECT_EQ(CountsOf(status), (Counts{5, 2, 2}));
}

TYPED_TEST(FitTest, StrideSkipsWhatLiesBetweenPoints) {
  constexpr int kDims = TypeParam::value;
  constexpr std::size_t kStride = kDims + 2;
  Random random(8);
  std::vector<float> packed;
  std::vector<float> spread(50 * kStride, kNan);
  for (std::size_t i = 0; i < 50; ++i) {
    const auto point = RandomPoint<static_cast<std::size_t>(kDims)>(
        PointKind::kUniform, random);
    packed.insert(packed.end(), point.begin(), point.end());
    std::copy(point.begin(), point.end(), &spread[i * kStride]);
  }
  EXPECT_EQ(BoundPoints<kDims>({spread.data(), 50, kStride}),
            this->Bound(packed));
  // One point, again and again.
  packed.resize(kDims);
  EXPECT_EQ(BoundPoints<kDims>({packed.data(), 50, 0}), this->Bound(packed));
}

TYPED_TEST(FitTest, PointsThatCannotBeReadAreRefused) {
  constexpr int kDims = TypeParam::value;
  FitStatus status;
  EXPECT_TRUE(Refuses(
      [&] {
        BoundPoints<kDims>({nullptr, 3}, &status);
      },
      {"BoundPoints", "points.coords: expected 3 points",
       "got a null pointer"}));
  const std::vector<float> coords(kDims + 1, 1.f);
  const auto* misaligned = reinterpret_cast<const float*>(
      reinterpret_cast<std::uintptr_t>(coords.data()) + 1);
  EXPECT_TRUE(Refuses(
      [&] {
        BoundPoints<kDims>({misaligned, 1}, &status);
      },
      {"BoundPoints", "points.coords: expected", "aligned to 4 bytes",
       "got a misaligned one"}));
  EXPECT_EQ(CountsOf(status), (Counts{0, 0, 0}));
}

// Refused before the first point is read, or this would crash. Of count and
// stride, the larger is to blame.
TYPED_TEST(FitTest, PointsBeyondTheAddressSpaceAreRefused) {
  constexpr int kDims = TypeParam::value;
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  const std::vector<float> coords(kDims, 1.f);
  EXPECT_TRUE(Refuses(
      [&] {
        BoundPoints<kDims>({coords.data(), kMost});
      },
      {"BoundPoints", "points.count: expected",
       "got " + std::to_string(kMost)}));
  EXPECT_TRUE(Refuses(
      [&] {
        BoundPoints<kDims>({coords.data(), 3, kMost / 4});
      },
      {"BoundPoints", "points.stride: expected a stride with which 3 points",
       "got " + std::to_string(kMost / 4)}));
}

TYPED_TEST(FitTest, InvertedBoxIsRefused) {
  constexpr int kDims = TypeParam::value;
  FitStatus status;
  for (int k = 0; k < kDims; ++k) {
    const std::string axis = '[' + std::to_string(k) + ']';
    auto box = this->UnitBox();
    box.min[k] = 2.f;
    EXPECT_TRUE(Refuses(
        [&] { BoundAabb(box, &status); },
        {"BoundAabb", "box: expected min" + axis, "max" + axis, "got 2", "1"}));
    // Empty in one axis only is not Empty().
    box.min[k] = kInfinity;
    box.max[k] = -kInfinity;
    EXPECT_TRUE(Refuses([&] { BoundAabb(box, &status); },
                        {"BoundAabb", "box: expected min" + axis}));
  }
  EXPECT_EQ(CountsOf(status), (Counts{0, 0, 0}));
}

}  // namespace
}  // namespace halfspace::testing
