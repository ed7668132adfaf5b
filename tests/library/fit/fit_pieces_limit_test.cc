// What is too large for a bound is too large for each piece of a segment.
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "halfspace/fit.h"
#include "tests/library/support/dims.h"

namespace halfspace::testing {
namespace {

template <typename Dims>
class FitPiecesLimitTest : public ::testing::Test {};
TYPED_TEST_SUITE(FitPiecesLimitTest, AllDims, DimsNames);

// Either end, and although every piece but the last one would be small enough.
TYPED_TEST(FitPiecesLimitTest, OfCoordinatesIsTwoToThe125) {
  constexpr int kDims = TypeParam::value;
  std::array<Aabo<kDims>, 4> pieces;
  Segment<kDims> segment{};
  FitStatus status;
  segment.b.back() = 0x1p125f;
  for (int side = 0; side < 2; ++side) {
    BoundSegmentPieces<kDims>(segment, pieces, &status);
    std::swap(segment.a, segment.b);
  }
  EXPECT_EQ(status.everything, 0u);
  segment.b.back() = 0x1.000002p125f;
  for (int side = 0; side < 2; ++side) {
    BoundSegmentPieces<kDims>(segment, pieces, &status);
    for (const auto& piece : pieces) {
      EXPECT_EQ(piece, Aabo<kDims>::Everything());
    }
    std::swap(segment.a, segment.b);
  }
  EXPECT_EQ(status.everything, 2 * pieces.size());
  EXPECT_EQ(status.first_everything, 2 * pieces.size());
}

}  // namespace
}  // namespace halfspace::testing
