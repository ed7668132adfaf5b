// What quantized bounds refuse, in the name of which call, and that nothing
// changes then.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/quantized/quantized_answers.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/misaligned.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class QuantizedErrorsTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Element = typename Case::Element;
  static constexpr std::size_t kObjects = 130;

  // The quantized bounds are as they were made.
  void ExpectUnchanged() {
    ASSERT_EQ(quantized_.size(), kObjects);
    EXPECT_TRUE(quantized_.Fits());
    const std::vector<Target> target = {TargetsUnderTest().front()};
    for (int i = 0; i < 5; ++i) {
      const auto query = MakeQuantizedQuery<FloatView>(bounds_, random_);
      const Answer before = AnswerByMask(copy_, kObjects, query, target[0]);
      EXPECT_TRUE(AnswersEverywhere(before, quantized_, query, target));
    }
  }

  // The calls for one query and for many refuse `world`, and write nothing.
  template <typename AnyWorld>
  void ExpectAllRefuse(const AnyWorld& world, std::string_view argument,
                       std::string_view expected, std::string_view given) {
    using Query = typename FloatView::Query;
    const Query query = Query::Everything();
    const auto refuses = [&](std::string_view name, const auto& call) {
      EXPECT_TRUE(Refuses(call, {"halfspace: ", name, argument, "expected",
                                 expected, "got", given}));
    };
    CallOutputs outputs;
    ForEachCall(world, query, {}, outputs, refuses);
    EXPECT_TRUE(outputs.Untouched());
    ForEachManyCall(world, std::span(&query, 1), {}, outputs, refuses);
    EXPECT_TRUE(outputs.Untouched());
  }

  Random random_{31};
  std::vector<typename FloatView::Bound> bounds_ =
      MakeQuantizedBounds<FloatView>(QuantizedInputKind::kUniform, kObjects,
                                     random_);
  World<FloatView> world_{bounds_};
  QuantizedBounds<FloatView, Element> quantized_{world_.view()};
  const QuantizedBounds<FloatView, Element> copy_ = quantized_;
};

TYPED_TEST_SUITE(QuantizedErrorsTest, FewQuantizedCases, QuantizedCaseNames);

TYPED_TEST(QuantizedErrorsTest, IndexPastTheEndIsRefused) {
  QuantizedWorld<typename TypeParam::View, typename TypeParam::Element> world(
      this->world_);
  const auto bound = this->bounds_.front();
  for (std::size_t index : {std::size_t{130}, ~std::size_t{0}}) {
    const std::string given = "got " + std::to_string(index);
    const char* expected = "index: expected less than the size, 130";
    EXPECT_TRUE(Refuses([&] { this->quantized_.Set(index, bound); },
                        {"QuantizedBounds::Set", expected, given}));
    EXPECT_TRUE(Refuses([&] { this->quantized_.EraseBySwap(index); },
                        {"QuantizedBounds::EraseBySwap", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.Get(index); },
                        {"QuantizedWorld::Get", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.Set(index, bound); },
                        {"QuantizedWorld::Set", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.EraseBySwap(index); },
                        {"QuantizedWorld::EraseBySwap", expected, given}));
  }
  this->ExpectUnchanged();
  EXPECT_EQ(world.size(), 130u);
  EXPECT_EQ(world.quantized().size(), 130u);
}

TYPED_TEST(QuantizedErrorsTest, RequantizeRefusesBadPlanesAndChangesNothing) {
  using View = typename TypeParam::View;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    const std::string name = "QuantizedBounds::Requantize: floats, plane " +
                             std::to_string(p) + ": expected";
    View view = this->world_.view();
    PlaneOf(view, p) = nullptr;
    EXPECT_TRUE(Refuses([&] { this->quantized_.Requantize(view); },
                        {name, "a plane of 130 floats", "got a null pointer"}));
    this->ExpectUnchanged();
    view = this->world_.view();
    PlaneOf(view, p) = Misaligned(PlaneOf(view, p));
    EXPECT_TRUE(Refuses([&] { this->quantized_.Requantize(view); },
                        {name, "aligned to 4 bytes", "got a misaligned one"}));
    this->ExpectUnchanged();
  }
}

TYPED_TEST(QuantizedErrorsTest, ListThatCannotBeReadIsRefused) {
  using View = typename TypeParam::View;
  using Bound = typename View::Bound;
  using AWorld = QuantizedWorld<View, typename TypeParam::Element>;
  const Bound* const none = nullptr;
  const auto refused = [&](Span<const Bound> bounds, std::string_view expected,
                           std::string_view given) {
    const auto parts = {
        std::string_view("QuantizedBounds::Requantize: bounds: expected"),
        expected, std::string_view("got"), given};
    EXPECT_TRUE(Refuses([&] { AWorld bad(bounds); }, parts));
    EXPECT_TRUE(Refuses([&] { this->quantized_.Requantize(bounds); }, parts));
    this->ExpectUnchanged();
  };
  refused({none, 3}, "memory for 3 elements", "a null pointer");
  refused({Misaligned(this->bounds_.data()), 3}, "a pointer aligned to 4",
          "a misaligned one");
  EXPECT_TRUE(AWorld(Span<const Bound>(none, 0)).empty());
  auto view = this->world_.view();
  PlaneOf(view, 0) = nullptr;
  EXPECT_TRUE(Refuses(
      [&] { AWorld bad(view); },
      {"QuantizedBounds::Requantize: floats, plane 0", "a null pointer"}));
  this->quantized_.Requantize(Span<const Bound>(none, 0));
  EXPECT_TRUE(this->quantized_.empty());
}

TYPED_TEST(QuantizedErrorsTest, SizeThatCannotExistIsRefused) {
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  const std::string given = "got " + std::to_string(most);
  EXPECT_TRUE(
      Refuses([&] { this->quantized_.Reserve(most); },
              {"QuantizedBounds", "size: expected at most", "objects", given}));
  QuantizedWorld<typename TypeParam::View, typename TypeParam::Element> world;
  EXPECT_TRUE(Refuses([&] { world.Reserve(most); },
                      {"size: expected at most", "objects", given}));
  const Span<const typename TypeParam::View::Bound> list(this->bounds_.data(),
                                                         most);
  EXPECT_TRUE(Refuses(
      [&] {
        QuantizedWorld<typename TypeParam::View, typename TypeParam::Element>
            bad(list);
      },
      {"QuantizedBounds", "size: expected at most", "objects", given}));
  auto view = this->world_.view();
  view.size = most;
  EXPECT_TRUE(
      Refuses([&] { this->quantized_.Requantize(view); },
              {"QuantizedBounds", "size: expected at most", "objects", given}));
  this->ExpectUnchanged();
}

TYPED_TEST(QuantizedErrorsTest, ViewOfNothingNeedsNoPlanes) {
  using View = typename TypeParam::View;
  this->quantized_.Requantize(View());
  EXPECT_TRUE(this->quantized_.empty());
  EXPECT_TRUE(this->quantized_.Fits());
  EXPECT_EQ(CountSurvivors(Refined(this->quantized_, View()),
                           View::Query::Everything()),
            0u);
}

TYPED_TEST(QuantizedErrorsTest, RefinedSizesMustAgree) {
  auto floats = this->world_.view();
  for (std::size_t size : {0u, 129u, 131u}) {
    floats.size = size;
    this->ExpectAllRefuse(Refined(this->quantized_, floats),
                          "world: ", "as many floats as quantized bounds, 130",
                          std::to_string(size));
  }
}

TYPED_TEST(QuantizedErrorsTest, RefiningPlanesAreChecked) {
  using View = typename TypeParam::View;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    auto floats = this->world_.view();
    PlaneOf(floats, p) = nullptr;
    const bool is_min = IsMinPlane<View>(p);
    this->ExpectAllRefuse(Refined(this->quantized_, floats),
                          (is_min ? "world.min[" : "world.max[") +
                              std::to_string(is_min ? p : p - kMinima<View>) +
                              "]: ",
                          "a plane of 130 floats", "a null pointer");
  }
}

// Outputs may overlap neither the quantized bounds nor the floats that refine
// them.
TYPED_TEST(QuantizedErrorsTest, OutputOverRefiningPlanesIsRefused) {
  using View = typename TypeParam::View;
  const auto query = View::Query::Everything();
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    View view = this->world_.view();
    auto* plane = const_cast<float*>(PlaneOf(view, p));
    const std::span<std::uint64_t> mask(
        reinterpret_cast<std::uint64_t*>(plane + 64), 3);
    EXPECT_TRUE(Refuses(
        [&] { RejectMask(Refined(this->quantized_, view), query, mask); },
        {"RejectMask: mask: expected", "apart", "an overlap with world."}));
  }
  const auto* quantized = this->quantized_.view().planes[0];
  const std::span<std::uint64_t> mask(
      reinterpret_cast<std::uint64_t*>(
          const_cast<std::remove_const_t<
              std::remove_reference_t<decltype(*quantized)>>*>(quantized)),
      3);
  EXPECT_TRUE(
      Refuses([&] { RejectMask(this->quantized_, query, mask); },
              {"RejectMask: mask: expected", "apart", "overlap with world."}));
  this->ExpectUnchanged();
}

}  // namespace
}  // namespace halfspace::testing
