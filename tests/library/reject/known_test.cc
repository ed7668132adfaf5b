// Answers worked out by hand, since two implementations that agree may share an
// error; and for each kind of world, a plane after another.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

constexpr float kAbove2 = 0x1.000002p1f;  // one ulp above 2
constexpr float kTiny = 0x1p-149f;        // one ulp above 0

enum class Fate { kKept, kRejected };
constexpr auto kKept = Fate::kKept;
constexpr auto kRejected = Fate::kRejected;

template <typename Bound>
struct KnownAnswer {
  const char* why;
  Bound bound;
  Fate fate;
};

// Expects every bound's fate, of many copies: whole words and a tail.
template <typename View>
void ExpectFates(
    const typename View::Query& query,
    std::initializer_list<KnownAnswer<typename View::Bound>> known) {
  constexpr std::size_t kCopies = 3 * 64 - 1;
  const std::vector<Target> targets = TargetsUnderTest();
  for (const auto& [why, bound, fate] : known) {
    const World<View> world(std::vector(kCopies, bound));
    const bool rejected = fate == Fate::kRejected;
    const Answer answer(kCopies, [&](std::size_t) { return rejected; });
    EXPECT_TRUE(AnswersEverywhere(answer, world, query, targets)) << why;
  }
}

// Each plane by itself, one ulp beyond it, and NaN, are in KnownPlanesTest. The
// queries are the corner simplex with vertices 0 and 2 on every axis: X, Y
// and Z go from 0 to 2, and D = -(X + Y + Z) from -2 to 0. Boxes are written as
// their minima, then their maxima. A point has D = -(x + y + z) as both minimum
// and maximum.
TEST(KnownTest, Simplices) {
  ExpectFates<SimplexView3>(
      {{2, 2, 2, 0}},
      {
          {"point (1/2, 1/2, 1/2), inside", {{.5f, .5f, .5f, -1.5f}}, kKept},
          {"point (2, 2, 2), outside, but behind no plane",
           {{2, 2, 2, -6}},
           kKept},
          {"point (3, 0, 0), X", {{3, 0, 0, -3}}, kRejected},
          {"point (0, 0, 3), Z", {{0, 0, 3, -3}}, kRejected},
          {"point (2, -3, 0), D alone: 1 > 0", {{2, -3, 0, 1}}, kRejected},
          {"point (1, 1, -2) touches D", {{1, 1, -2, 0}}, kKept},
          {"touches all planes", {{2, 2, 2, 0}}, kKept},
          {"one ulp beyond D", {{0, 0, 0, kTiny}}, kRejected},
          {"everything", UpSimplex3::Everything(), kKept},
          {"empty", UpSimplex3::Empty(), kRejected},
      });
}

TEST(KnownTest, Boxes) {
  ExpectFates<AabbView3>(
      {{0, 0, 0}, {2, 2, 2}},
      {
          {"inside", {{.5f, .5f, .5f}, {1, 1, 1}}, kKept},
          {"touches the corner (2, 2, 2)", {{2, 2, 2}, {3, 3, 3}}, kKept},
          {"touches the corner (0, 0, 0)", {{-1, -1, -1}, {0, 0, 0}}, kKept},
          {"min X alone", {{3, 0, 0}, {4, 2, 2}}, kRejected},
          {"max X alone", {{-2, 0, 0}, {-1, 2, 2}}, kRejected},
          {"everything", Aabb3::Everything(), kKept},
          {"empty", Aabb3::Empty(), kRejected},
      });
}

TEST(KnownTest, Octahedra) {
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
          {"one ulp beyond min D", {{0, 0, 0, kTiny}, {2, 2, 2, 1}}, kRejected},
          {"one ulp beyond max D",
           {{0, 0, 0, -9}, {2, 2, 2, -kAbove2}},
           kRejected},
          {"everything", Aabo3::Everything(), kKept},
          {"empty", Aabo3::Empty(), kRejected},
      });
}

// The same planes, asked as a simplex and as a box, forget the other planes.
TEST(KnownTest, OctahedraAsSimplicesAndAsBoxes) {
  // The point (1, 1, 1): only max D tells it from the query.
  const AaboWorld3 world(std::vector<Aabo3>{{{1, 1, 1, -3}, {1, 1, 1, -3}}});
  const Aabo3 query{{0, 0, 0, -2}, {2, 2, 2, 0}};
  EXPECT_EQ(CountSurvivors(world, query), 0u);
  EXPECT_EQ(CountSurvivors(world.view().simplex(), query.down()), 1u);
  EXPECT_EQ(CountSurvivors(world.view().aabb(), query.aabb()), 1u);
}

template <typename View>
void ExpectFatesOf(const typename View::Bound& bound) {
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  ExpectFates<View>(Query::Everything(),
                    {
                        {"a bound", bound, kKept},
                        {"everything", Bound::Everything(), kKept},
                        {"empty: +inf > FLT_MAX", Bound::Empty(), kRejected},
                    });
  ExpectFates<View>(Query::Empty(), {
                                        {"a bound", bound, kRejected},
                                        {"everything: -FLT_MAX > -inf",
                                         Bound::Everything(), kRejected},
                                        {"empty", Bound::Empty(), kRejected},
                                    });
}

TEST(KnownTest, QueriesForEverythingAndForNothing) {
  ExpectFatesOf<SimplexView3>({{1, 2, 3, -6}});
  ExpectFatesOf<AabbView3>({{1, 2, 3}, {4, 5, 6}});
  ExpectFatesOf<AaboView3>({{1, 2, 3, -6}, {1, 2, 3, -6}});
}

class KnownPlanesTest : public ::testing::TestWithParam<FlatCase> {};

// The query goes from -1 to 1, from -2 to 2, from -4 to 4, ...: no limit can
// stand in for another.
TEST_P(KnownPlanesTest, EachHasItsOwnLimit) {
  const FlatCase& kind = GetParam();
  kind.WithScalar([&]<typename T>(T) {
    constexpr T kNotANumber = std::numeric_limits<T>::quiet_NaN();
    const std::size_t count = kind.seen.plane_count;
    const std::vector<Target> targets = TargetsUnderTest();
    std::array<T, 10> query{};
    std::array<T, 10> limits{};
    for (std::size_t p = 0; p < count; ++p) {
      const int k = static_cast<int>(p % kind.seen.axes);
      limits[p] = std::ldexp(kind.IsMinPlane(p) ? T{1} : T{-1}, k);
      query[kind.Opposing(p)] = limits[p];
    }
    // Objects that lie at the limits but in plane p, and in plane `other`.
    const auto check = [&](std::size_t p, T value, std::size_t other,
                           T other_value, bool rejected) {
      constexpr std::size_t kCopies = 3 * 64 - 1;
      std::array<std::vector<T>, 10> planes;
      PlanePointers pointers{};
      for (std::size_t n = 0; n < count; ++n) {
        const T at = n == p ? value : n == other ? other_value : limits[n];
        planes[n].assign(kCopies, at);
        pointers[n] = planes[n].data();
      }
      EXPECT_TRUE(AnswersEverywhere(
          Answer(kCopies, [=](std::size_t) { return rejected; }),
          kind.world(pointers, kCopies), {query.data(), 1}, targets))
          << kind.PlaneName(p) << " = " << value << ", "
          << kind.PlaneName(other) << " = " << other_value;
    };
    for (std::size_t p = 0; p < count; ++p) {
      const std::size_t other = (p + 1) % count;
      const T beyond = limits[p] + (kind.IsMinPlane(p) ? T{0.5} : T{-0.5});
      check(p, limits[p], other, limits[other], false);
      check(p, beyond, other, limits[other], true);
      check(p, std::nextafter(limits[p], beyond), other, limits[other], true);
      check(p, kNotANumber, other, limits[other], false);
      check(p, beyond, other, kNotANumber, true);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(, KnownPlanesTest,
                         ::testing::ValuesIn(WholeFlatCases()), FlatCaseName);

}  // namespace
}  // namespace halfspace::testing
