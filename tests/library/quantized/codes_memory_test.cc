// Memory that cannot be had, at every allocation in turn: worlds, codes and
// coded worlds are then as they were.
#include <gtest/gtest.h>

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/codes.h"
#include "halfspace/world.h"
#include "tests/library/quantized/coded_answers.h"
#include "tests/library/support/coded_cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/limited_memory.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class CodesMemoryTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using TheCodes = Codes<FloatView, typename Case::Code>;
  using Coded = CodedWorld<FloatView, typename Case::Code>;
  static constexpr std::size_t kObjects = 128;  // no room for one more

  // Lets change(subject) fail at its first allocation, at its second, ..., and
  // calls check(subject) after each failure.
  template <typename Subject, typename Change, typename Check>
  static void ExpectStrong(Subject& subject, Change change, Check check) {
    bool is_done = false;
    std::size_t failures = 0;
    for (; !is_done; ++failures) {
      allocations_left = failures;
      try {
        change(subject);
        is_done = true;
      } catch (const std::bad_alloc&) {
      }
      allocations_left = kNoAllocationLimit;
      if (!is_done) check(subject);
      if (::testing::Test::HasFatalFailure()) return;
    }
    EXPECT_GT(failures, 1u);
  }

  // The world answers as when it was made.
  void CheckWorld(const Coded& world) {
    ASSERT_EQ(world.size(), kObjects);
    ASSERT_EQ(world.codes().size(), kObjects);
    for (const auto& query : queries_) {
      const Answer exact = ReferenceAnswer(floats_.view(), query);
      ASSERT_TRUE(AnswersEverywhere(exact, world, query, target_));
    }
  }
  void CheckCodes(const TheCodes& codes) {
    ASSERT_EQ(codes.size(), kObjects);
    ASSERT_TRUE(codes.Fits());
    for (const auto& query : queries_) {
      ASSERT_TRUE(CodesAnswerEverywhere(codes, floats_.view(), query, target_));
    }
  }

  void CheckFloats(const World<FloatView>& floats) {
    ASSERT_EQ(floats.size(), kObjects);
    for (std::size_t i = 0; i < kObjects; ++i) {
      ASSERT_EQ(floats.Get(i), bounds_[i]) << i;
    }
  }

  Random random_{53};
  std::vector<typename FloatView::Bound> bounds_ =
      MakeCodedBounds<FloatView>(CodedInputKind::kUniform, kObjects, random_);
  World<FloatView> floats_{bounds_};
  std::vector<typename FloatView::Query> queries_ = {
      MakeCodedQuery<FloatView>(bounds_, random_),
      MakeCodedQuery<FloatView>(bounds_, random_)};
  std::vector<Target> target_ = {TargetsUnderTest().front()};
};

TYPED_TEST_SUITE(CodesMemoryTest, FewCodedCases, CodedCaseNames);

TYPED_TEST(CodesMemoryTest, CodedWorldStaysAsItWas) {
  typename TestFixture::Coded world;
  for (const auto& bound : this->bounds_) world.Push(bound);
  ASSERT_EQ(world.size(), 128u);
  this->ExpectStrong(
      world, [&](auto& changed) { changed.Push(this->bounds_[0]); },
      [&](const auto& same) { this->CheckWorld(same); });
  EXPECT_EQ(world.size(), this->kObjects + 1);
}

TYPED_TEST(CodesMemoryTest, CodesStayAsTheyWere) {
  typename TestFixture::TheCodes codes{this->floats_.view()};
  const auto check = [&](const auto& same) { this->CheckCodes(same); };
  auto pushed = codes;
  this->ExpectStrong(
      pushed, [&](auto& changed) { changed.Push(this->bounds_[0]); }, check);
  EXPECT_EQ(pushed.size(), this->kObjects + 1);
  const auto more = MakeCodedBounds<typename TypeParam::View>(
      CodedInputKind::kClustered, 1000, this->random_);
  const World<typename TypeParam::View> floats(more);
  this->ExpectStrong(
      codes, [&](auto& changed) { changed.Recode(floats.view()); }, check);
  EXPECT_EQ(codes.size(), 1000u);
}

// A caller's class, whose assignments the compiler writes.
template <typename Member>
struct Holder {
  Member member;
};

template <typename Member>
constexpr bool OnlyCopyingThrows() {
  using Held = Holder<Member>;
  return !std::is_nothrow_copy_assignable_v<Held> &&
         std::is_nothrow_move_assignable_v<Held> &&
         std::is_nothrow_move_constructible_v<Held> &&
         std::is_nothrow_swappable_v<Held>;
}

TYPED_TEST(CodesMemoryTest, CopyAssignmentLeavesItAsItWas) {
  using View = typename TypeParam::View;
  using ACoded = typename TestFixture::Coded;
  using ACodes = typename TestFixture::TheCodes;
  static_assert(OnlyCopyingThrows<World<View>>());
  static_assert(OnlyCopyingThrows<ACodes>());
  static_assert(OnlyCopyingThrows<ACoded>());
  const auto assign = [this](auto subject, const auto& from, auto check) {
    this->ExpectStrong(
        subject, [&](auto& changed) { changed = from; },
        [&](const auto& same) { check(same.member); });
    EXPECT_EQ(subject.member.size(), from.member.size());
  };
  const auto more =
      MakeCodedBounds<View>(CodedInputKind::kClustered, 1000, this->random_);
  const World<View> more_floats(more);
  assign(Holder<World<View>>{this->floats_}, Holder<World<View>>{more_floats},
         [&](const auto& same) { this->CheckFloats(same); });
  assign(Holder<ACodes>{ACodes(this->floats_.view())},
         Holder<ACodes>{ACodes(more_floats.view())},
         [&](const auto& same) { this->CheckCodes(same); });
  assign(Holder<ACoded>{ACoded(this->floats_.view())},
         Holder<ACoded>{ACoded(more_floats.view())},
         [&](const auto& same) { this->CheckWorld(same); });
}

}  // namespace
}  // namespace halfspace::testing
