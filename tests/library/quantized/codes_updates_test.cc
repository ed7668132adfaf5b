// Codes that follow their floats through updates, and worlds that own both,
// against a plain vector of bounds.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/codes.h"
#include "tests/library/quantized/coded_answers.h"
#include "tests/library/support/coded_cases.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class CodesUpdatesTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Code = typename Case::Code;
  using Bound = typename FloatView::Bound;
  using TheCodes = Codes<FloatView, Code>;
  using Coded = CodedWorld<FloatView, Code>;
  using Model = std::vector<Bound>;

  Model RandomBounds(std::size_t count) {
    return MakeCodedBounds<FloatView>(
        kCodedInputKinds[random_() % kCodedInputKinds.size()], count, random_);
  }

  Bound RandomBound() { return RandomBounds(1).front(); }

  // The answers of codes, and of codes confirmed by floats, to a few queries.
  void ExpectAnswers(const TheCodes& codes, Model& model) {
    const World<FloatView> floats(model);
    ASSERT_EQ(codes.size(), model.size());
    for (int i = 0; i < 3; ++i) {
      const auto query = MakeCodedQuery<FloatView>(model, random_);
      ASSERT_TRUE(CodesAnswerEverywhere(codes, floats.view(), query, target_));
    }
  }

  void ExpectAnswers(const Coded& world, Model& model) {
    ASSERT_EQ(world.size(), model.size());
    ASSERT_EQ(world.empty(), model.empty());
    ASSERT_EQ(world.codes().size(), model.size());
    // Any NaN differs from itself.
    for (std::size_t i = 0; i < model.size(); ++i) {
      ASSERT_TRUE(world.Get(i) == model[i] || !(model[i] == model[i])) << i;
    }
    const World<FloatView> rebuilt(model);
    for (int i = 0; i < 3; ++i) {
      const auto query = MakeCodedQuery<FloatView>(model, random_);
      const Answer exact = ReferenceAnswer(rebuilt.view(), query);
      ASSERT_TRUE(AnswersEverywhere(exact, world, query, target_));
      ASSERT_TRUE(KeepsAllOf(exact, AnswerByMask(world.codes(), model.size(),
                                                 query, target_.front())));
    }
  }

  Random random_{23};
  std::vector<Target> target_ = {TargetsUnderTest().front()};
};

TYPED_TEST_SUITE(CodesUpdatesTest, FewCodedCases, CodedCaseNames);

TYPED_TEST(CodesUpdatesTest, CodesFollowTheFloats) {
  typename TestFixture::Model model = this->RandomBounds(40);
  typename TestFixture::TheCodes codes{
      World<typename TypeParam::View>(model).view()};
  for (std::size_t step = 0; step < Scaled(2000); ++step) {
    const std::uint64_t operation = this->random_() % 100;
    const auto bound = this->RandomBound();
    const std::size_t at = model.empty() ? 0 : this->random_() % model.size();
    SCOPED_TRACE(::testing::Message()
                 << "step " << step << ", operation " << operation);
    if (operation < 50 || model.empty()) {
      ASSERT_EQ(codes.Push(bound), model.size());
      model.push_back(bound);
    } else if (operation < 65) {
      codes.Set(at, bound);
      model[at] = bound;
    } else if (operation < 85) {
      codes.EraseBySwap(at);
      model[at] = model.back();
      model.pop_back();
    } else if (operation < 87) {
      codes.Reserve(this->random_() % 400);
    } else if (operation < 89) {
      codes.Clear();
      model.clear();
    } else if (operation < 92) {
      model = this->RandomBounds(this->random_() % 300);
      codes.Recode(World<typename TypeParam::View>(model).view());
      ASSERT_TRUE(codes.Fits());
    } else if (operation < 96) {
      auto copy = codes;
      codes = copy;
      this->ExpectAnswers(copy, model);
    } else {
      auto moved = std::move(codes);
      codes = std::move(moved);
    }
    this->ExpectAnswers(codes, model);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(CodesUpdatesTest, CodedWorldFollowsTheModel) {
  typename TestFixture::Coded world;
  typename TestFixture::Model model;
  for (std::size_t step = 0; step < Scaled(2000); ++step) {
    const std::uint64_t operation = this->random_() % 100;
    const auto bound = this->RandomBound();
    const std::size_t at = model.empty() ? 0 : this->random_() % model.size();
    SCOPED_TRACE(::testing::Message()
                 << "step " << step << ", operation " << operation);
    if (operation < 60 || model.empty()) {
      ASSERT_EQ(world.Push(bound), model.size());
      model.push_back(bound);
    } else if (operation < 70) {
      world.Set(at, bound);
      model[at] = bound;
    } else if (operation < 88) {
      world.EraseBySwap(at);
      model[at] = model.back();
      model.pop_back();
    } else if (operation < 90) {
      world.Clear();
      model.clear();
    } else if (operation < 92) {
      world.Recode();
      ASSERT_TRUE(world.Fits());
    } else if (operation < 94) {
      model = this->RandomBounds(this->random_() % 300);
      world = typename TestFixture::Coded(std::span(std::as_const(model)));
      ASSERT_TRUE(world.Fits());
    } else if (operation < 97) {
      auto copy = world;
      world = copy;
      this->ExpectAnswers(copy, model);
    } else {
      auto moved = std::move(world);
      world = std::move(moved);
    }
    this->ExpectAnswers(world, model);
    if (this->HasFatalFailure()) return;
  }
}

// A map that has one code for everything tells nothing apart.
TYPED_TEST(CodesUpdatesTest, PushToAnEmptyMapIsConservative) {
  using View = typename TypeParam::View;
  typename TestFixture::TheCodes codes;
  EXPECT_TRUE(codes.empty());
  EXPECT_EQ(CountSurvivors(codes, View::Query::Everything()), 0u);
  typename TestFixture::Model model = this->RandomBounds(100);
  for (const auto& bound : model) codes.Push(bound);
  this->ExpectAnswers(codes, model);
  EXPECT_EQ(CountSurvivors(codes, View::Query::Everything()), 100u);
  EXPECT_FALSE(codes.Fits());
}

TYPED_TEST(CodesUpdatesTest, CopiesAreApart) {
  typename TestFixture::Model model = this->RandomBounds(300);
  typename TestFixture::Coded world{std::span(std::as_const(model))};
  auto copy = world;
  copy.Set(3, this->RandomBound());
  copy.EraseBySwap(0);
  this->ExpectAnswers(world, model);
  copy = world;
  world.Clear();
  world.Recode();
  this->ExpectAnswers(copy, model);
}

TYPED_TEST(CodesUpdatesTest, MovedFromAndSelfAssignedAreUsable) {
  typename TestFixture::Model model = this->RandomBounds(300);
  typename TestFixture::Coded world{std::span(std::as_const(model))};
  auto& same = world;
  world = same;
  this->ExpectAnswers(world, model);
  world = std::move(same);
  this->ExpectAnswers(world, model);
  const auto taken = std::move(world);
  this->ExpectAnswers(taken, model);
  typename TestFixture::Model none;
  this->ExpectAnswers(world, none);
  for (const auto& bound : model) world.Push(bound);
  this->ExpectAnswers(world, model);

  const World<typename TypeParam::View> floats(model);
  typename TestFixture::TheCodes codes{floats.view()};
  const auto taken_codes = std::move(codes);
  this->ExpectAnswers(taken_codes, model);
  this->ExpectAnswers(codes, none);
  for (const auto& bound : model) codes.Push(bound);
  this->ExpectAnswers(codes, model);
}

TYPED_TEST(CodesUpdatesTest, WorldsNeedNoView) {
  using View = typename TypeParam::View;
  typename TestFixture::Model model = this->RandomBounds(300);
  const World<View> floats(model);
  const auto query = MakeCodedQuery<View>(model, this->random_);
  const typename TestFixture::TheCodes codes(floats);
  this->ExpectAnswers(codes, model);
  typename TestFixture::TheCodes recoded;
  recoded.Recode(floats);
  this->ExpectAnswers(recoded, model);
  EXPECT_TRUE(AnswersEverywhere(ReferenceAnswer(floats.view(), query),
                                Confirmed(codes, floats), query,
                                this->target_));
  static_assert(std::is_same_v<decltype(Codes(floats)), Codes<View>>);
}

}  // namespace
}  // namespace halfspace::testing
