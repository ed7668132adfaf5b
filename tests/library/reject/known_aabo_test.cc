// A point (x, y, ...) has D = -(x + y + ...) as both minimum and maximum.
#include <gtest/gtest.h>

#include "tests/library/reject/known_answers.h"

namespace halfspace::testing {
namespace {

constexpr auto kKept = Fate::kKept;
constexpr auto kRejected = Fate::kRejected;

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownAaboTest, TwoDimensions) {
  ExpectFates<AaboView2>(
      {{0, 0, -2}, {2, 2, 0}},
      {
          {"point (1, 1/2), inside", {{1, .5f, -1.5f}, {1, .5f, -1.5f}}, kKept},
          {"point (1, 1) touches max D: -2", {{1, 1, -2}, {1, 1, -2}}, kKept},
          {"point (0, 0) touches min D: 0", {{0, 0, 0}, {0, 0, 0}}, kKept},
          {"point (2, 1), in the box, max D alone: -3 < -2",
           {{2, 1, -3}, {2, 1, -3}},
           kRejected},
          {"segment (-2, 1) to (1, -2), min D alone: 1 > 0",
           {{-2, -2, 1}, {1, 1, 1}},
           kRejected},
          {"min X alone", {{3, 0, -2}, {4, 2, 0}}, kRejected},
          {"max X alone", {{-4, 0, -2}, {-1, 2, 0}}, kRejected},
          {"min Y alone", {{0, 3, -2}, {2, 4, 0}}, kRejected},
          {"max Y alone", {{0, -4, -2}, {2, -1, 0}}, kRejected},
          {"one ulp beyond min D", {{0, 0, kTiny}, {2, 2, 1}}, kRejected},
          {"one ulp beyond max D", {{0, 0, -9}, {2, 2, -kAbove2}}, kRejected},
          {"a NaN rejects nothing", {{0, 0, kNan}, {2, 2, 0}}, kKept},
          {"a NaN hides no other plane", {{0, 0, kNan}, {2, 2, -3}}, kRejected},
          {"everything", Aabo2::Everything(), kKept},
          {"empty", Aabo2::Empty(), kRejected},
      });
}
#endif

TEST(KnownAaboTest, ThreeDimensions) {
  ExpectFates<AaboView3>(
      {{0, 0, 0, -2}, {2, 2, 2, 0}},
      {
          {"point (1/2, 1/2, 1/2), inside",
           {{.5f, .5f, .5f, -1.5f}, {.5f, .5f, .5f, -1.5f}},
           kKept},
          {"point (1, 1, 0) touches max D: -2",
           {{1, 1, 0, -2}, {1, 1, 0, -2}},
           kKept},
          {"point (1, 1, 1), in the box, max D alone: -3 < -2",
           {{1, 1, 1, -3}, {1, 1, 1, -3}},
           kRejected},
          {"triangle (1, -1, -1), (-1, 1, -1), (-1, -1, 1), min D alone: 1 > 0",
           {{-1, -1, -1, 1}, {1, 1, 1, 1}},
           kRejected},
          {"min X alone", {{3, 0, 0, -2}, {4, 2, 2, 0}}, kRejected},
          {"max X alone", {{-4, 0, 0, -2}, {-1, 2, 2, 0}}, kRejected},
          {"min Y alone", {{0, 3, 0, -2}, {2, 4, 2, 0}}, kRejected},
          {"max Y alone", {{0, -4, 0, -2}, {2, -1, 2, 0}}, kRejected},
          {"min Z alone", {{0, 0, 3, -2}, {2, 2, 4, 0}}, kRejected},
          {"max Z alone", {{0, 0, -4, -2}, {2, 2, -1, 0}}, kRejected},
          {"one ulp beyond min D", {{0, 0, 0, kTiny}, {2, 2, 2, 1}}, kRejected},
          {"one ulp beyond max D",
           {{0, 0, 0, -9}, {2, 2, 2, -kAbove2}},
           kRejected},
          {"a NaN rejects nothing", {{0, 0, 0, -2}, {2, 2, 2, kNan}}, kKept},
          {"a NaN hides no other plane",
           {{0, 0, 3, -2}, {2, 2, 4, kNan}},
           kRejected},
          {"everything", Aabo3::Everything(), kKept},
          {"empty", Aabo3::Empty(), kRejected},
      });
}

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownAaboTest, FourDimensions) {
  ExpectFates<AaboView4>(
      {{0, 0, 0, 0, -2}, {2, 2, 2, 2, 0}},
      {
          {"point (1/4, ...), inside",
           {{.25f, .25f, .25f, .25f, -1}, {.25f, .25f, .25f, .25f, -1}},
           kKept},
          {"point (1, 1, 1, 1), in the box, max D alone: -4 < -2",
           {{1, 1, 1, 1, -4}, {1, 1, 1, 1, -4}},
           kRejected},
          {"segment (1, -2, 0, 0) to (-2, 1, 0, 0), min D alone: 1 > 0",
           {{-2, -2, 0, 0, 1}, {1, 1, 0, 0, 1}},
           kRejected},
          {"min X alone", {{3, 0, 0, 0, -2}, {4, 2, 2, 2, 0}}, kRejected},
          {"max X alone", {{-4, 0, 0, 0, -2}, {-1, 2, 2, 2, 0}}, kRejected},
          {"min Y alone", {{0, 3, 0, 0, -2}, {2, 4, 2, 2, 0}}, kRejected},
          {"max Y alone", {{0, -4, 0, 0, -2}, {2, -1, 2, 2, 0}}, kRejected},
          {"min Z alone", {{0, 0, 3, 0, -2}, {2, 2, 4, 2, 0}}, kRejected},
          {"max Z alone", {{0, 0, -4, 0, -2}, {2, 2, -1, 2, 0}}, kRejected},
          {"min W alone", {{0, 0, 0, 3, -2}, {2, 2, 2, 4, 0}}, kRejected},
          {"max W alone", {{0, 0, 0, -4, -2}, {2, 2, 2, -1, 0}}, kRejected},
          {"touches all planes", {{2, 2, 2, 2, 0}, {0, 0, 0, 0, -2}}, kKept},
          {"everything", Aabo4::Everything(), kKept},
          {"empty", Aabo4::Empty(), kRejected},
      });
}
#endif

// The same planes, asked as a simplex and as a box, forget the other planes.
TEST(KnownAaboTest, SeenAsSimplexAndAsBox) {
  // The point (1, 1, 1): only max D tells it from the query.
  const AaboWorld3 world(std::vector<Aabo3>{{{1, 1, 1, -3}, {1, 1, 1, -3}}});
  const Aabo3 query{{0, 0, 0, -2}, {2, 2, 2, 0}};
  EXPECT_EQ(CountSurvivors(world, query), 0u);
  EXPECT_EQ(CountSurvivors(world.view().simplex(), query.down()), 1u);
  EXPECT_EQ(CountSurvivors(world.view().aabb(), query.aabb()), 1u);
}

TEST(KnownAaboTest, QueryForEverything) {
  ExpectFates<AaboView3>(
      Aabo3::Everything(),
      {
          {"point (1, 2, 3)", {{1, 2, 3, -6}, {1, 2, 3, -6}}, kKept},
          {"everything", Aabo3::Everything(), kKept},
          {"empty", Aabo3::Empty(), kRejected},
      });
}

TEST(KnownAaboTest, QueryForNothing) {
  ExpectFates<AaboView3>(
      Aabo3::Empty(),
      {
          {"point (1, 2, 3)", {{1, 2, 3, -6}, {1, 2, 3, -6}}, kRejected},
          {"everything", Aabo3::Everything(), kRejected},
          {"empty", Aabo3::Empty(), kRejected},
      });
}

// The query goes from -1 to 1, from -2 to 2, ...: no limit can stand in for
// another.
TEST(KnownAaboTest, EachAxisHasItsOwnLimits) {
  ExpectFates<AaboView3>(
      {{-1, -2, -4, -8}, {1, 2, 4, 8}},
      {
          {"all minima", {{1, 2, 4, 8}, {9, 9, 9, 9}}, kKept},
          {"all maxima", {{-9, -9, -9, -9}, {-1, -2, -4, -8}}, kKept},
          {"min X", {{1.5f, 0, 0, 0}, {9, 9, 9, 9}}, kRejected},
          {"min Y", {{0, 3, 0, 0}, {9, 9, 9, 9}}, kRejected},
          {"min Z", {{0, 0, 6, 0}, {9, 9, 9, 9}}, kRejected},
          {"min D", {{0, 0, 0, 8.5f}, {9, 9, 9, 9}}, kRejected},
          {"max X", {{-9, -9, -9, -9}, {-1.5f, 0, 0, 0}}, kRejected},
          {"max Y", {{-9, -9, -9, -9}, {0, -3, 0, 0}}, kRejected},
          {"max Z", {{-9, -9, -9, -9}, {0, 0, -6, 0}}, kRejected},
          {"max D", {{-9, -9, -9, -9}, {0, 0, 0, -8.5f}}, kRejected},
      });
}

}  // namespace
}  // namespace halfspace::testing
