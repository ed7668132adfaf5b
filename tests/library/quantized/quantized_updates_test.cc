// Quantized bounds that follow their floats through updates, and worlds that
// own both, against a plain vector of bounds.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedUpdatesTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Element = typename Case::Element;
  using Bound = typename FloatView::Bound;
  using TheBounds = QuantizedBounds<FloatView, Element>;
  using TheWorld = QuantizedWorld<FloatView, Element>;
  using Model = std::vector<Bound>;

  Model RandomBounds(std::size_t count) {
    return MakeQuantizedBounds<FloatView>(
        kQuantizedInputKinds[random_() % kQuantizedInputKinds.size()], count,
        random_);
  }

  Bound RandomBound() { return RandomBounds(1).front(); }

  // The answers of quantized bounds, and of quantized bounds refined by floats,
  // to a few queries.
  void ExpectAnswers(const TheBounds& quantized, Model& model) {
    const World<FloatView> floats(model);
    ASSERT_EQ(quantized.size(), model.size());
    for (int i = 0; i < 3; ++i) {
      const auto query = MakeQuantizedQuery<FloatView>(model, random_);
      ASSERT_TRUE(
          QuantizedAnswersEverywhere(quantized, floats.view(), query, target_));
    }
  }

  void ExpectAnswers(const TheWorld& world, Model& model) {
    ASSERT_EQ(world.size(), model.size());
    ASSERT_EQ(world.empty(), model.empty());
    ASSERT_EQ(world.quantized().size(), model.size());
    // Any NaN differs from itself.
    for (std::size_t i = 0; i < model.size(); ++i) {
      ASSERT_TRUE(world.Get(i) == model[i] || !(model[i] == model[i])) << i;
    }
    const World<FloatView> rebuilt(model);
    for (int i = 0; i < 3; ++i) {
      const auto query = MakeQuantizedQuery<FloatView>(model, random_);
      const Answer exact = ReferenceAnswer(rebuilt.view(), query);
      ASSERT_TRUE(AnswersEverywhere(exact, world, query, target_));
      ASSERT_TRUE(
          KeepsAllOf(exact, AnswerByMask(world.quantized(), model.size(), query,
                                         target_.front())));
    }
  }

  Random random_{23};
  std::vector<Target> target_ = {TargetsUnderTest().front()};
};

TYPED_TEST_SUITE(QuantizedUpdatesTest, FewQuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedUpdatesTest, QuantizedBoundsFollowTheFloats) {
  typename TestFixture::Model model = this->RandomBounds(40);
  typename TestFixture::TheBounds quantized{
      World<typename TypeParam::View>(model).view()};
  for (std::size_t step = 0; step < Scaled(2000); ++step) {
    const std::uint64_t operation = this->random_() % 100;
    const auto bound = this->RandomBound();
    const std::size_t at = model.empty() ? 0 : this->random_() % model.size();
    SCOPED_TRACE(::testing::Message()
                 << "step " << step << ", operation " << operation);
    if (operation < 50 || model.empty()) {
      ASSERT_EQ(quantized.Push(bound), model.size());
      model.push_back(bound);
    } else if (operation < 65) {
      quantized.Set(at, bound);
      model[at] = bound;
    } else if (operation < 85) {
      quantized.EraseBySwap(at);
      model[at] = model.back();
      model.pop_back();
    } else if (operation < 87) {
      quantized.Reserve(this->random_() % 400);
    } else if (operation < 89) {
      quantized.Clear();
      model.clear();
    } else if (operation < 92) {
      model = this->RandomBounds(this->random_() % 300);
      quantized.Requantize(World<typename TypeParam::View>(model).view());
      ASSERT_TRUE(quantized.Fits());
    } else if (operation < 96) {
      auto copy = quantized;
      quantized = copy;
      this->ExpectAnswers(copy, model);
    } else {
      auto moved = std::move(quantized);
      quantized = std::move(moved);
    }
    this->ExpectAnswers(quantized, model);
    if (this->HasFatalFailure()) return;
  }
}

TYPED_TEST(QuantizedUpdatesTest, QuantizedWorldFollowsTheModel) {
  typename TestFixture::TheWorld world;
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
      world.Requantize();
      ASSERT_TRUE(world.Fits());
    } else if (operation < 94) {
      model = this->RandomBounds(this->random_() % 300);
      world = typename TestFixture::TheWorld(std::span(std::as_const(model)));
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

// A map that has one level for everything tells nothing apart.
TYPED_TEST(QuantizedUpdatesTest, PushToAnEmptyMapIsConservative) {
  using View = typename TypeParam::View;
  typename TestFixture::TheBounds quantized;
  EXPECT_TRUE(quantized.empty());
  EXPECT_EQ(CountSurvivors(quantized, View::Query::Everything()), 0u);
  typename TestFixture::Model model = this->RandomBounds(100);
  for (const auto& bound : model) quantized.Push(bound);
  this->ExpectAnswers(quantized, model);
  EXPECT_EQ(CountSurvivors(quantized, View::Query::Everything()), 100u);
  EXPECT_FALSE(quantized.Fits());
}

TYPED_TEST(QuantizedUpdatesTest, CopiesAreApart) {
  typename TestFixture::Model model = this->RandomBounds(300);
  typename TestFixture::TheWorld world{std::span(std::as_const(model))};
  auto copy = world;
  copy.Set(3, this->RandomBound());
  copy.EraseBySwap(0);
  this->ExpectAnswers(world, model);
  copy = world;
  world.Clear();
  world.Requantize();
  this->ExpectAnswers(copy, model);
}

TYPED_TEST(QuantizedUpdatesTest, MovedFromAndSelfAssignedAreUsable) {
  typename TestFixture::Model model = this->RandomBounds(300);
  typename TestFixture::TheWorld world{std::span(std::as_const(model))};
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
  typename TestFixture::TheBounds quantized{floats.view()};
  const auto taken_quantized = std::move(quantized);
  this->ExpectAnswers(taken_quantized, model);
  this->ExpectAnswers(quantized, none);
  for (const auto& bound : model) quantized.Push(bound);
  this->ExpectAnswers(quantized, model);
}

TYPED_TEST(QuantizedUpdatesTest, WorldsNeedNoView) {
  using View = typename TypeParam::View;
  typename TestFixture::Model model = this->RandomBounds(300);
  const World<View> floats(model);
  const auto query = MakeQuantizedQuery<View>(model, this->random_);
  const typename TestFixture::TheBounds quantized(floats);
  this->ExpectAnswers(quantized, model);
  typename TestFixture::TheBounds requantized;
  requantized.Requantize(floats);
  this->ExpectAnswers(requantized, model);
  EXPECT_TRUE(AnswersEverywhere(ReferenceAnswer(floats.view(), query),
                                Refined(quantized, floats), query,
                                this->target_));
  static_assert(
      std::is_same_v<decltype(QuantizedBounds(floats)), QuantizedBounds<View>>);
}

}  // namespace
}  // namespace halfspace::testing
