// Every pair of special values (object, query) in every plane and every lane,
// against a rule that looks only at their bits.
#include "tests/library/support/special_values.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/fp_modes.h"

namespace halfspace::testing {
namespace {

// The rule itself, by hand.
constexpr float kNan = std::bit_cast<float>(0x7fc00000u);
constexpr float kInfinity = std::bit_cast<float>(0x7f800000u);
static_assert(IsGreater(1.f, 0.f) && !IsGreater(0.f, 1.f));
static_assert(!IsGreater(1.f, 1.f));
static_assert(!IsGreater(0.f, -0.f) && !IsGreater(-0.f, 0.f));
static_assert(IsGreater(-1.f, -2.f) && !IsGreater(-2.f, -1.f));
static_assert(!IsGreater(kNan, 0.f) && !IsGreater(0.f, kNan));
static_assert(!IsGreater(kNan, kNan));
static_assert(IsGreater(kInfinity, 0x1.fffffep127f));
static_assert(IsGreater(-0x1.fffffep127f, -kInfinity));
static_assert(IsGreater(1.0 + 0x1p-52, 1.0) && !IsGreater(1.0, 1.0 + 0x1p-52));
static_assert(!IsGreater(0.0, -0.0) && IsGreater(-1.0, -2.0));
static_assert(!IsGreater(double{kNan}, 0.0) && !IsGreater(0.0, double{kNan}));
static_assert(IsGreater(double{kInfinity}, 0x1.fffffffffffffp1023));

// A word, then a tail with every lane of a vector, then a partial vector.
std::size_t Objects() { return 64 + 2 * MostLanes() - 1; }

// Special values in one plane, object i having value i + shift, and nothing
// that could reject in the other planes.
template <typename View>
class SpecialPlane {
 public:
  using Scalar = ScalarOf<View>;

  SpecialPlane(std::size_t plane, Scalar query_value)
      : plane_(plane), query_value_(query_value) {
    for (std::size_t p = 0; p < kPlanes<View>; ++p) {
      const Scalar never{IsMinPlane<View>(p) ? -1.f : 1.f};
      planes_[p].assign(Objects(), never);
      PlaneOf(view_, p) = planes_[p].data();
      OpposingValue<View>(query_, p) = 0;
    }
    view_.size = Objects();
    OpposingValue<View>(query_, plane) = query_value;
  }

  void Shift(std::size_t shift) {
    for (std::size_t i = 0; i < Objects(); ++i) {
      planes_[plane_][i] =
          kSpecialValues<Scalar>[(i + shift) % kSpecialValues<Scalar>.size()];
    }
  }

  bool Rejects(std::size_t i) const {
    const Scalar object = planes_[plane_][i];
    return IsMinPlane<View>(plane_) ? IsGreater(object, query_value_)
                                    : IsGreater(query_value_, object);
  }

  const View& view() const { return view_; }
  const typename View::Query& query() const { return query_; }

 private:
  std::size_t plane_;
  Scalar query_value_;
  std::array<std::vector<Scalar>, kPlanes<View>> planes_;
  View view_;
  typename View::Query query_;
};

// Calls check(plane) for every plane, query value and rotation of the values.
// At a smaller scale, every seventh rotation: each value is in each lane at
// full scale.
template <typename View, typename Check>
void ForEachPair(Check check) {
  const std::size_t step = TestScale() < 1 ? 7 : 1;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    for (const auto query_value : kSpecialValues<ScalarOf<View>>) {
      SpecialPlane<View> plane(p, query_value);
      for (std::size_t shift = 0; shift < kSpecialValues<ScalarOf<View>>.size();
           shift += step) {
        plane.Shift(shift);
        check(plane);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

template <typename Case>
class SpecialValuesTest : public ::testing::Test {};

TYPED_TEST_SUITE(SpecialValuesTest, WholeCases, CaseNames);

TYPED_TEST(SpecialValuesTest, FollowTheRuleInEveryLane) {
  const std::vector<Target> targets = TargetsUnderTest();
  ForEachPair<typename TypeParam::View>([&](const auto& plane) {
    const Answer answer(Objects(),
                        [&](std::size_t i) { return plane.Rejects(i); });
    ASSERT_TRUE(
        AnswersEverywhere(answer, plane.view(), plane.query(), targets));
  });
}

// What engines initialise boxes to. As bounds.h says: a limit on one plane
// rejects it, and Everything() does not.
TYPED_TEST(SpecialValuesTest, UntouchedBoxesAreNumbersToAScan) {
  using View = typename TypeParam::View;
  constexpr auto kMost = std::numeric_limits<ScalarOf<View>>::max();
  SpecialPlane<View> plane(0, 0);
  View view = plane.view();
  const std::vector<ScalarOf<View>> minima(Objects(), kMost);
  const std::vector<ScalarOf<View>> maxima(Objects(), -kMost);
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    PlaneOf(view, p) = (IsMinPlane<View>(p) ? minima : maxima).data();
  }
  const auto everything = View::Query::Everything();
  const std::vector<Target> targets = TargetsUnderTest();
  EXPECT_TRUE(
      AnswersEverywhere(Answer(Objects(), [](std::size_t) { return false; }),
                        view, everything, targets));
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    auto query = everything;
    auto& limit = OpposingValue<View>(query, p);
    limit = std::nextafter(limit, ScalarOf<View>{0});
    EXPECT_TRUE(
        AnswersEverywhere(Answer(Objects(), [](std::size_t) { return true; }),
                          view, query, targets));
  }
}

// A process may run with subnormals flushed to zero. That may cost survivors
// that could have been rejected, never the other way round.
TYPED_TEST(SpecialValuesTest, NothingMoreIsRejectedWithSubnormalsFlushed) {
  std::vector<std::uint64_t> mask(MaskWords(Objects()));
  std::size_t kept_more = 0;
  ForEachPair<typename TypeParam::View>([&](const auto& plane) {
    for (Target target : TargetsUnderTest()) {
      for (Schedule schedule : kSchedules) {
        {
          const FlushDenormals flush;
          RejectMask(plane.view(), plane.query(), mask,
                     {.schedule = schedule, .target = target});
        }
        for (std::size_t i = 0; i < Objects(); ++i) {
          const bool rejected = ((mask[i / 64] >> (i % 64)) & 1) != 0;
          if (plane.Rejects(i) && !rejected) ++kept_more;
          if (!plane.Rejects(i)) {
            ASSERT_FALSE(rejected) << target.name() << ", object " << i;
          }
        }
      }
    }
  });
  // Else the mode was not on, and this has tested nothing.
  if (FlushDenormals::kAvailable) {
    EXPECT_GT(kept_more, 0u);
  }
}

}  // namespace
}  // namespace halfspace::testing
