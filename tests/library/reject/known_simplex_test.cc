// A point (x, y, ...) has the up simplex {x, y, ..., -(x + y + ...)}.
#include <gtest/gtest.h>

#include "tests/library/reject/known_answers.h"

namespace halfspace::testing {
namespace {

constexpr auto kKept = Fate::kKept;
constexpr auto kRejected = Fate::kRejected;

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownSimplexTest, TwoDimensions) {
  ExpectFates<SimplexView2>(
      {{2, 2, 0}},
      {
          {"point (1, 1/2), inside", {{1, 0.5f, -1.5f}}, kKept},
          {"point (2, 2), outside, but behind no plane", {{2, 2, -4}}, kKept},
          {"point (3, 0), X", {{3, 0, -3}}, kRejected},
          {"point (0, 3), Y", {{0, 3, -3}}, kRejected},
          {"point (-1, -1), D alone: 2 > 0", {{-1, -1, 2}}, kRejected},
          {"point (-1, 1) touches D", {{-1, 1, 0}}, kKept},
          {"touches all planes", {{2, 2, 0}}, kKept},
          {"one ulp beyond X", {{kAbove2, 0, -3}}, kRejected},
          {"one ulp beyond Y", {{0, kAbove2, -3}}, kRejected},
          {"one ulp beyond D", {{0, 0, kTiny}}, kRejected},
          {"-0 and 0 touch", {{0, 0, -0.f}}, kKept},
          {"a NaN rejects nothing", {{kNan, 0, 0}}, kKept},
          {"a NaN hides no other plane", {{kNan, 3, 0}}, kRejected},
          {"everything", UpSimplex2::Everything(), kKept},
          {"empty", UpSimplex2::Empty(), kRejected},
      });
}
#endif

TEST(KnownSimplexTest, ThreeDimensions) {
  ExpectFates<SimplexView3>(
      {{2, 2, 2, 0}},
      {
          {"point (1/2, 1/2, 1/2), inside", {{.5f, .5f, .5f, -1.5f}}, kKept},
          {"point (2, 2, 2), outside, but behind no plane",
           {{2, 2, 2, -6}},
           kKept},
          {"point (3, 0, 0), X", {{3, 0, 0, -3}}, kRejected},
          {"point (0, 3, 0), Y", {{0, 3, 0, -3}}, kRejected},
          {"point (0, 0, 3), Z", {{0, 0, 3, -3}}, kRejected},
          {"point (2, -3, 0), D alone: 1 > 0", {{2, -3, 0, 1}}, kRejected},
          {"point (1, 1, -2) touches D", {{1, 1, -2, 0}}, kKept},
          {"touches all planes", {{2, 2, 2, 0}}, kKept},
          {"one ulp beyond X", {{kAbove2, 0, 0, -3}}, kRejected},
          {"one ulp beyond Y", {{0, kAbove2, 0, -3}}, kRejected},
          {"one ulp beyond Z", {{0, 0, kAbove2, -3}}, kRejected},
          {"one ulp beyond D", {{0, 0, 0, kTiny}}, kRejected},
          {"a NaN rejects nothing", {{0, 0, 0, kNan}}, kKept},
          {"a NaN hides no other plane", {{0, 0, 3, kNan}}, kRejected},
          {"everything", UpSimplex3::Everything(), kKept},
          {"empty", UpSimplex3::Empty(), kRejected},
      });
}

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownSimplexTest, FourDimensions) {
  ExpectFates<SimplexView4>(
      {{2, 2, 2, 2, 0}},
      {
          {"point (1/4, ...), inside", {{.25f, .25f, .25f, .25f, -1}}, kKept},
          {"point (2, 2, 2, 2), outside, but behind no plane",
           {{2, 2, 2, 2, -8}},
           kKept},
          {"point (3, 0, 0, 0), X", {{3, 0, 0, 0, -3}}, kRejected},
          {"point (0, 3, 0, 0), Y", {{0, 3, 0, 0, -3}}, kRejected},
          {"point (0, 0, 3, 0), Z", {{0, 0, 3, 0, -3}}, kRejected},
          {"point (0, 0, 0, 3), W", {{0, 0, 0, 3, -3}}, kRejected},
          {"point (2, 2, -4, -1), D alone: 1 > 0",
           {{2, 2, -4, -1, 1}},
           kRejected},
          {"point (2, -2, 2, -2) touches D", {{2, -2, 2, -2, 0}}, kKept},
          {"touches all planes", {{2, 2, 2, 2, 0}}, kKept},
          {"one ulp beyond X", {{kAbove2, 0, 0, 0, -3}}, kRejected},
          {"one ulp beyond W", {{0, 0, 0, kAbove2, -3}}, kRejected},
          {"one ulp beyond D", {{0, 0, 0, 0, kTiny}}, kRejected},
          {"a NaN rejects nothing", {{0, 0, 0, kNan, 0}}, kKept},
          {"a NaN hides no other plane", {{3, 0, 0, kNan, 0}}, kRejected},
          {"everything", UpSimplex4::Everything(), kKept},
          {"empty", UpSimplex4::Empty(), kRejected},
      });
}
#endif

TEST(KnownSimplexTest, QueryForEverything) {
  ExpectFates<SimplexView3>(
      DownSimplex3::Everything(),
      {
          {"point (1, 2, 3)", {{1, 2, 3, -6}}, kKept},
          {"everything", UpSimplex3::Everything(), kKept},
          {"empty: +inf > FLT_MAX", UpSimplex3::Empty(), kRejected},
      });
}

TEST(KnownSimplexTest, QueryForNothing) {
  ExpectFates<SimplexView3>(
      DownSimplex3::Empty(),
      {
          {"point (1, 2, 3)", {{1, 2, 3, -6}}, kRejected},
          {"everything: -FLT_MAX > -inf", UpSimplex3::Everything(), kRejected},
          {"empty", UpSimplex3::Empty(), kRejected},
      });
}

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownSimplexTest, NanInTheQueryRejectsNothing) {
  ExpectFates<SimplexView2>({{kNan, 2, 0}},
                            {
                                {"X cannot be known", {{1e30f, 0, -3}}, kKept},
                                {"Y rejects", {{0, 3, -3}}, kRejected},
                                {"empty, by Y", UpSimplex2::Empty(), kRejected},
                            });
}
#endif

// Limits of 1, 2, 4, 8 and 16: none can stand in for another.
#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownSimplexTest, EachAxisHasItsOwnLimit) {
  ExpectFates<SimplexView4>({{1, 2, 4, 8, 16}},
                            {
                                {"all limits", {{1, 2, 4, 8, 16}}, kKept},
                                {"X", {{1.5f, 0, 0, 0, 0}}, kRejected},
                                {"Y", {{0, 3, 0, 0, 0}}, kRejected},
                                {"Z", {{0, 0, 6, 0, 0}}, kRejected},
                                {"W", {{0, 0, 0, 12, 0}}, kRejected},
                                {"D", {{0, 0, 0, 0, 24}}, kRejected},
                            });
  ExpectFates<SimplexView3>({{1, 2, 4, 8}},
                            {
                                {"all limits", {{1, 2, 4, 8}}, kKept},
                                {"X", {{1.5f, 0, 0, 0}}, kRejected},
                                {"Y", {{0, 3, 0, 0}}, kRejected},
                                {"Z", {{0, 0, 6, 0}}, kRejected},
                                {"D", {{0, 0, 0, 12}}, kRejected},
                            });
}
#endif

}  // namespace
}  // namespace halfspace::testing
