// Boxes are written as their minima, then their maxima.
#include <gtest/gtest.h>

#include "tests/library/reject/known_answers.h"

namespace halfspace::testing {
namespace {

constexpr auto kKept = Fate::kKept;
constexpr auto kRejected = Fate::kRejected;

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownAabbTest, TwoDimensions) {
  ExpectFates<AabbView2>(
      {{0, 0}, {2, 2}},
      {
          {"inside", {{0.5f, 0.5f}, {1, 1}}, kKept},
          {"around", {{-9, -9}, {9, 9}}, kKept},
          {"touches the corner (2, 2)", {{2, 2}, {3, 3}}, kKept},
          {"touches the corner (0, 0)", {{-1, -1}, {0, 0}}, kKept},
          {"-0 and 0 touch", {{-1, -1}, {-0.f, -0.f}}, kKept},
          {"min X alone", {{3, 0}, {4, 2}}, kRejected},
          {"max X alone", {{-2, 0}, {-1, 2}}, kRejected},
          {"min Y alone", {{0, 3}, {2, 4}}, kRejected},
          {"max Y alone", {{0, -2}, {2, -1}}, kRejected},
          {"one ulp beyond min X", {{kAbove2, 0}, {4, 2}}, kRejected},
          {"one ulp beyond max X", {{-2, 0}, {-kTiny, 2}}, kRejected},
          {"one ulp beyond min Y", {{0, kAbove2}, {2, 4}}, kRejected},
          {"one ulp beyond max Y", {{0, -2}, {2, -kTiny}}, kRejected},
          {"a NaN rejects nothing", {{kNan, 0}, {1, 1}}, kKept},
          {"a NaN hides no other plane", {{kNan, 0}, {-1, 1}}, kRejected},
          {"inverted, but overlapping", {{2, 2}, {0, 0}}, kKept},
          {"everything", Aabb2::Everything(), kKept},
          {"empty", Aabb2::Empty(), kRejected},
      });
}
#endif

TEST(KnownAabbTest, ThreeDimensions) {
  ExpectFates<AabbView3>(
      {{0, 0, 0}, {2, 2, 2}},
      {
          {"inside", {{.5f, .5f, .5f}, {1, 1, 1}}, kKept},
          {"touches the corner (2, 2, 2)", {{2, 2, 2}, {3, 3, 3}}, kKept},
          {"touches the corner (0, 0, 0)", {{-1, -1, -1}, {0, 0, 0}}, kKept},
          {"min X alone", {{3, 0, 0}, {4, 2, 2}}, kRejected},
          {"max X alone", {{-2, 0, 0}, {-1, 2, 2}}, kRejected},
          {"min Y alone", {{0, 3, 0}, {2, 4, 2}}, kRejected},
          {"max Y alone", {{0, -2, 0}, {2, -1, 2}}, kRejected},
          {"min Z alone", {{0, 0, 3}, {2, 2, 4}}, kRejected},
          {"max Z alone", {{0, 0, -2}, {2, 2, -1}}, kRejected},
          {"one ulp beyond min Z", {{0, 0, kAbove2}, {2, 2, 4}}, kRejected},
          {"one ulp beyond max Z", {{0, 0, -2}, {2, 2, -kTiny}}, kRejected},
          {"a NaN rejects nothing", {{0, 0, 0}, {1, 1, kNan}}, kKept},
          {"a NaN hides no other plane", {{0, 0, 3}, {1, 1, kNan}}, kRejected},
          {"everything", Aabb3::Everything(), kKept},
          {"empty", Aabb3::Empty(), kRejected},
      });
}

#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownAabbTest, FourDimensions) {
  ExpectFates<AabbView4>(
      {{0, 0, 0, 0}, {2, 2, 2, 2}},
      {
          {"inside", {{.5f, .5f, .5f, .5f}, {1, 1, 1, 1}}, kKept},
          {"touches (2, 2, 2, 2)", {{2, 2, 2, 2}, {3, 3, 3, 3}}, kKept},
          {"touches (0, 0, 0, 0)", {{-1, -1, -1, -1}, {0, 0, 0, 0}}, kKept},
          {"min X alone", {{3, 0, 0, 0}, {4, 2, 2, 2}}, kRejected},
          {"max X alone", {{-2, 0, 0, 0}, {-1, 2, 2, 2}}, kRejected},
          {"min Y alone", {{0, 3, 0, 0}, {2, 4, 2, 2}}, kRejected},
          {"max Y alone", {{0, -2, 0, 0}, {2, -1, 2, 2}}, kRejected},
          {"min Z alone", {{0, 0, 3, 0}, {2, 2, 4, 2}}, kRejected},
          {"max Z alone", {{0, 0, -2, 0}, {2, 2, -1, 2}}, kRejected},
          {"min W alone", {{0, 0, 0, 3}, {2, 2, 2, 4}}, kRejected},
          {"max W alone", {{0, 0, 0, -2}, {2, 2, 2, -1}}, kRejected},
          {"a NaN rejects nothing", {{0, 0, 0, kNan}, {1, 1, 1, 1}}, kKept},
          {"everything", Aabb4::Everything(), kKept},
          {"empty", Aabb4::Empty(), kRejected},
      });
}
#endif

TEST(KnownAabbTest, QueryForEverything) {
  ExpectFates<AabbView3>(Aabb3::Everything(),
                         {
                             {"a box", {{1, 2, 3}, {4, 5, 6}}, kKept},
                             {"everything", Aabb3::Everything(), kKept},
                             {"empty", Aabb3::Empty(), kRejected},
                         });
}

TEST(KnownAabbTest, QueryForNothing) {
  ExpectFates<AabbView3>(Aabb3::Empty(),
                         {
                             {"a box", {{1, 2, 3}, {4, 5, 6}}, kRejected},
                             {"everything", Aabb3::Everything(), kRejected},
                             {"empty", Aabb3::Empty(), kRejected},
                         });
}

// The query goes from -1 to 1, from -2 to 2, ...: no limit can stand in for
// another.
#if !defined(HALFSPACE_TEST_ONLY_3D)
TEST(KnownAabbTest, EachAxisHasItsOwnLimits) {
  ExpectFates<AabbView4>(
      {{-1, -2, -4, -8}, {1, 2, 4, 8}},
      {
          {"all minima", {{1, 2, 4, 8}, {9, 9, 9, 9}}, kKept},
          {"all maxima", {{-9, -9, -9, -9}, {-1, -2, -4, -8}}, kKept},
          {"min X", {{1.5f, 0, 0, 0}, {9, 9, 9, 9}}, kRejected},
          {"min Y", {{0, 3, 0, 0}, {9, 9, 9, 9}}, kRejected},
          {"min Z", {{0, 0, 6, 0}, {9, 9, 9, 9}}, kRejected},
          {"min W", {{0, 0, 0, 8.5f}, {9, 9, 9, 9}}, kRejected},
          {"max X", {{-9, -9, -9, -9}, {-1.5f, 0, 0, 0}}, kRejected},
          {"max Y", {{-9, -9, -9, -9}, {0, -3, 0, 0}}, kRejected},
          {"max Z", {{-9, -9, -9, -9}, {0, 0, -6, 0}}, kRejected},
          {"max W", {{-9, -9, -9, -9}, {0, 0, 0, -8.5f}}, kRejected},
      });
}
#endif

}  // namespace
}  // namespace halfspace::testing
