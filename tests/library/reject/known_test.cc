// Answers worked out by hand, since two implementations that agree may share an
// error: for each kind of world, a plane after another; Everything() and
// Empty().
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

// Of many copies of a bound: whole words and a tail.
constexpr std::size_t kCopies = 3 * 64 - 1;

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
  const auto expect = [](const Bound& object, const Query& query, bool rejected,
                         const char* why) {
    const World<View> world(std::vector(kCopies, object));
    EXPECT_TRUE(AnswersEverywhere(
        Answers(kCopies, [=](std::size_t) { return rejected; }),
        AnyWorld(world), {&query, 1}, TargetsUnderTest()))
        << why;
  };
  expect(bound, Query::Everything(), false, "a bound");
  expect(Bound::Everything(), Query::Everything(), false, "everything");
  expect(Bound::Empty(), Query::Everything(), true, "empty: +inf > FLT_MAX");
  expect(bound, Query::Empty(), true, "a bound");
  expect(Bound::Everything(), Query::Empty(), true, "-FLT_MAX > -inf");
  expect(Bound::Empty(), Query::Empty(), true, "empty");
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
      std::array<std::vector<T>, 10> planes;
      PlanePointers pointers{};
      for (std::size_t n = 0; n < count; ++n) {
        const T at = n == p ? value : n == other ? other_value : limits[n];
        planes[n].assign(kCopies, at);
        pointers[n] = planes[n].data();
      }
      EXPECT_TRUE(AnswersEverywhere(
          Answers(kCopies, [=](std::size_t) { return rejected; }),
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
