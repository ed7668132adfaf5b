// Memory that cannot be had, at every allocation in turn: worlds, quantized
// bounds and quantized worlds are then as they were.
#include <gtest/gtest.h>

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/world.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/limited_memory.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedMemoryTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using TheBounds = QuantizedBounds<FloatView, typename Case::Element>;
  using TheWorld = QuantizedWorld<FloatView, typename Case::Element>;
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
  void CheckWorld(const TheWorld& world) {
    ASSERT_EQ(world.size(), kObjects);
    ASSERT_EQ(world.quantized().size(), kObjects);
    for (const auto& query : queries_) {
      const Answer exact = ReferenceAnswer(floats_.view(), query);
      ASSERT_TRUE(AnswersEverywhere(exact, world, query, target_));
    }
  }
  void CheckQuantized(const TheBounds& quantized) {
    ASSERT_EQ(quantized.size(), kObjects);
    ASSERT_TRUE(quantized.Fits());
    for (const auto& query : queries_) {
      ASSERT_TRUE(QuantizedAnswersEverywhere(quantized, floats_.view(), query,
                                             target_));
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
      MakeQuantizedBounds<FloatView>(QuantizedInputKind::kUniform, kObjects,
                                     random_);
  World<FloatView> floats_{bounds_};
  std::vector<typename FloatView::Query> queries_ = {
      MakeQuantizedQuery<FloatView>(bounds_, random_),
      MakeQuantizedQuery<FloatView>(bounds_, random_)};
  std::vector<Target> target_ = {TargetsUnderTest().front()};
};

TYPED_TEST_SUITE(QuantizedMemoryTest, FewQuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedMemoryTest, QuantizedWorldStaysAsItWas) {
  typename TestFixture::TheWorld world;
  for (const auto& bound : this->bounds_) world.Push(bound);
  ASSERT_EQ(world.size(), 128u);
  this->ExpectStrong(
      world, [&](auto& changed) { changed.Push(this->bounds_[0]); },
      [&](const auto& same) { this->CheckWorld(same); });
  EXPECT_EQ(world.size(), this->kObjects + 1);
}

TYPED_TEST(QuantizedMemoryTest, QuantizedBoundsStayAsTheyWere) {
  typename TestFixture::TheBounds quantized{this->floats_.view()};
  const auto check = [&](const auto& same) { this->CheckQuantized(same); };
  auto pushed = quantized;
  this->ExpectStrong(
      pushed, [&](auto& changed) { changed.Push(this->bounds_[0]); }, check);
  EXPECT_EQ(pushed.size(), this->kObjects + 1);
  const auto more = MakeQuantizedBounds<typename TypeParam::View>(
      QuantizedInputKind::kClustered, 1000, this->random_);
  const World<typename TypeParam::View> floats(more);
  this->ExpectStrong(
      quantized, [&](auto& changed) { changed.Requantize(floats.view()); },
      check);
  EXPECT_EQ(quantized.size(), 1000u);
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

TYPED_TEST(QuantizedMemoryTest, CopyAssignmentLeavesItAsItWas) {
  using View = typename TypeParam::View;
  using AWorld = typename TestFixture::TheWorld;
  using ABounds = typename TestFixture::TheBounds;
  static_assert(OnlyCopyingThrows<World<View>>());
  static_assert(OnlyCopyingThrows<ABounds>());
  static_assert(OnlyCopyingThrows<AWorld>());
  const auto assign = [this](auto subject, const auto& from, auto check) {
    this->ExpectStrong(
        subject, [&](auto& changed) { changed = from; },
        [&](const auto& same) { check(same.member); });
    EXPECT_EQ(subject.member.size(), from.member.size());
  };
  const auto more = MakeQuantizedBounds<View>(QuantizedInputKind::kClustered,
                                              1000, this->random_);
  const World<View> more_floats(more);
  assign(Holder<World<View>>{this->floats_}, Holder<World<View>>{more_floats},
         [&](const auto& same) { this->CheckFloats(same); });
  assign(Holder<ABounds>{ABounds(this->floats_.view())},
         Holder<ABounds>{ABounds(more_floats.view())},
         [&](const auto& same) { this->CheckQuantized(same); });
  assign(Holder<AWorld>{AWorld(this->floats_.view())},
         Holder<AWorld>{AWorld(more_floats.view())},
         [&](const auto& same) { this->CheckWorld(same); });
}

}  // namespace
}  // namespace halfspace::testing
