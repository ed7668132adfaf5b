// What builders refuse of points, pieces and planes, and how they say it. What
// they refuse of numbers is in exact_answers.h.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "halfspace/fit.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

class FitPointErrorsTest : public ::testing::Test {
 protected:
  ~FitPointErrorsTest() override { EXPECT_EQ(status_.results, 0u); }

  std::array<float, 5> point_ = {1, 1, 1, 1, 1};
  FitStatus status_;
};

TEST_F(FitPointErrorsTest, PointsThatCannotBeRead) {
  const auto refused = [&](const auto& points, std::string_view expected,
                           std::string_view given) {
    EXPECT_REFUSED((BoundPoints(points, &status_)), "BoundPoints", expected,
                   given);
  };
  refused(Points3{nullptr, 3}, "points.coords: expected 3 points",
          "got a null pointer");
  refused(Points3{Misaligned(point_.data()), 1}, "points.coords: expected",
          "aligned to 4 bytes, got a misaligned");
  alignas(8) std::array<float, 4> room{};
  const auto* half = reinterpret_cast<const double*>(&room[1]);
  refused(Points<3, double>{half, 1}, "points.coords: expected",
          "aligned to 8 bytes");
  const std::array<double, 3> ones = {1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string argument = "points.coords[" + std::to_string(k) + "]";
    PointsSoa<3, double> soa{.coords = {}, .count = 1};
    soa.coords.fill(ones.data());
    soa.coords[k] = nullptr;
    refused(soa, argument, "1 points, got a null");
    soa.coords[k] = half;
    refused(soa, argument, "aligned to 8 bytes");
  }
  EXPECT_REFUSED((BoundTransformed(Points3{nullptr, 2}, Affine3{}, &status_)),
                 "BoundTransformed", "points.coords: expected 2 points",
                 "null");
  // Before the first point is read, or this would crash. Of count and stride,
  // the larger is to blame.
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  refused(Points3{point_.data(), kMost}, "points.count: expected",
          "got " + std::to_string(kMost));
  refused(Points3{point_.data(), 3, kMost / 4},
          "points.stride: expected a stride with which 3",
          "got " + std::to_string(kMost / 4));
}

TEST_F(FitPointErrorsTest, IndicesThatCannotBeRead) {
  const std::array<std::uint32_t, 3> zeros{};
  // Before any is read: the one point there is lies at index 0.
  const auto check = [&](const auto& points) {
    using Indices = std::span<const std::uint32_t>;
    const std::uint32_t* const none = nullptr;
    EXPECT_REFUSED((BoundPoints(points, Indices(none, 2), &status_)),
                   "BoundPoints", "2 indices", "a null pointer");
    EXPECT_REFUSED(
        (BoundPoints(points, Indices(Misaligned(zeros.data()), 2), &status_)),
        "BoundPoints", "aligned to 4", "misaligned");
    for (std::uint32_t bad : {1u, 0xffffffffu}) {
      const std::array<std::uint32_t, 3> indices = {0, 0, bad};
      EXPECT_REFUSED((BoundPoints(points, indices, &status_)), "BoundPoints",
                     "indices[2]: expected less than", "1",
                     "got " + std::to_string(bad));
    }
  };
  check(Points3{point_.data(), 1});
  check(PointsSoa3{{point_.data(), point_.data(), point_.data()}, 1});
  EXPECT_REFUSED((BoundPoints(Points3{nullptr, 0}, zeros)),
                 "indices[0]: expected less than", "0, got 0");
}

// Refused before the first is written, or this would crash.
TEST_F(FitPointErrorsTest, PiecesThatCannotBeWritten) {
  std::array<Aabo3, 3> room;
  const auto refused = [&](Aabo3* pieces, std::size_t count,
                           std::string_view expected) {
    EXPECT_REFUSED(
        (BoundSegmentPieces(Segment3{}, std::span(pieces, count), &status_)),
        "BoundSegmentPieces", "pieces: expected", expected);
  };
  refused(room.data(), (std::size_t{1} << 24) + 1,
          "at most 2^24 pieces, got 16777217");
  refused(nullptr, 2, "room for 2, got a null pointer");
  refused(Misaligned(room.data()), 2, "aligned to 4 bytes, got a misaligned");
}

TEST_F(FitPointErrorsTest, PlanesThatAreNotSixOrCannotBeRead) {
  const std::array<HalfSpace3, 7> planes{};
  const auto refused = [&](const HalfSpace3* pointer, std::size_t count,
                           std::string_view given) {
    EXPECT_REFUSED((BoundFrustum(std::span(pointer, count), &status_)),
                   "BoundFrustum: planes: expected", given);
  };
  refused(planes.data(), 7, "6 planes, got 7");
  refused(planes.data(), 5, "6 planes, got 5");
  refused(planes.data(), 0, "6 planes, got 0");
  refused(nullptr, 6, "6 planes, got a null pointer");
  refused(Misaligned(planes.data()), 6, "aligned to 4 bytes, got a misaligned");
}

}  // namespace
}  // namespace halfspace::testing
