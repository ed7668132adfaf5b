// Answers worked out by hand: planes seen as other bounds, Everything() and
// Empty(). What each plane rejects, special_values_test.cc checks by its bits.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "halfspace/world.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"

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

}  // namespace
}  // namespace halfspace::testing
