// What codes refuse, in whose name, and that nothing changes then.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "halfspace/codes.h"
#include "halfspace/reject.h"
#include "tests/library/quantized/coded_answers.h"
#include "tests/library/support/coded_cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/support/five_calls.h"
#include "tests/library/support/many_calls.h"
#include "tests/library/support/misaligned.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class CodesErrorsTest : public ::testing::Test {
 protected:
  using FloatView = typename Case::View;
  using Code = typename Case::Code;
  static constexpr std::size_t kObjects = 130;

  // The codes are as they were made.
  void ExpectUnchanged() {
    ASSERT_EQ(codes_.size(), kObjects);
    EXPECT_TRUE(codes_.Fits());
    const std::vector<Target> target = {TargetsUnderTest().front()};
    for (int i = 0; i < 5; ++i) {
      const auto query = MakeCodedQuery<FloatView>(bounds_, random_);
      const Answer before = AnswerByMask(copy_, kObjects, query, target[0]);
      EXPECT_TRUE(AnswersEverywhere(before, codes_, query, target));
    }
  }

  // The calls for one query and for many refuse `world`, and write nothing.
  template <typename AnyWorld>
  void ExpectAllRefuse(const AnyWorld& world, std::string_view argument,
                       std::string_view expected, std::string_view given) {
    using Query = typename FloatView::Query;
    const Query query = Query::Everything();
    const auto refuses = [&](std::string_view name, auto call) {
      EXPECT_TRUE(Refuses(call, {"halfspace: ", name, argument, "expected",
                                 expected, "got", given}));
    };
    CallOutputs outputs;
    ForEachCall(world, query, {}, outputs, refuses);
    EXPECT_TRUE(outputs.Untouched());
    ManyCallOutputs many_outputs;
    ForEachManyCall(world, std::span(&query, 1), {}, many_outputs, refuses);
    EXPECT_TRUE(many_outputs.Untouched());
  }

  Random random_{31};
  std::vector<typename FloatView::Bound> bounds_ =
      MakeCodedBounds<FloatView>(CodedInputKind::kUniform, kObjects, random_);
  World<FloatView> world_{bounds_};
  Codes<FloatView, Code> codes_{world_.view()};
  const Codes<FloatView, Code> copy_ = codes_;
};

TYPED_TEST_SUITE(CodesErrorsTest, FewCodedCases, CodedCaseNames);

TYPED_TEST(CodesErrorsTest, IndexPastTheEndIsRefused) {
  CodedWorld<typename TypeParam::View, typename TypeParam::Code> world(
      this->world_);
  const auto bound = this->bounds_.front();
  for (std::size_t index : {std::size_t{130}, ~std::size_t{0}}) {
    const std::string given = "got " + std::to_string(index);
    const char* expected = "index: expected less than the size, 130";
    EXPECT_TRUE(Refuses([&] { this->codes_.Set(index, bound); },
                        {"Codes::Set", expected, given}));
    EXPECT_TRUE(Refuses([&] { this->codes_.EraseBySwap(index); },
                        {"Codes::EraseBySwap", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.Get(index); },
                        {"CodedWorld::Get", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.Set(index, bound); },
                        {"CodedWorld::Set", expected, given}));
    EXPECT_TRUE(Refuses([&] { world.EraseBySwap(index); },
                        {"CodedWorld::EraseBySwap", expected, given}));
  }
  this->ExpectUnchanged();
  EXPECT_EQ(world.size(), 130u);
  EXPECT_EQ(world.codes().size(), 130u);
}

TYPED_TEST(CodesErrorsTest, RecodeRefusesBadPlanesAndChangesNothing) {
  using View = typename TypeParam::View;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    const std::string name =
        "Codes::Recode: floats, plane " + std::to_string(p) + ": expected";
    View view = this->world_.view();
    PlaneOf(view, p) = nullptr;
    EXPECT_TRUE(Refuses([&] { this->codes_.Recode(view); },
                        {name, "a plane of 130 floats", "got a null pointer"}));
    this->ExpectUnchanged();
    view = this->world_.view();
    PlaneOf(view, p) = Misaligned(PlaneOf(view, p));
    EXPECT_TRUE(Refuses([&] { this->codes_.Recode(view); },
                        {name, "aligned to 4 bytes", "got a misaligned one"}));
    this->ExpectUnchanged();
  }
}

TYPED_TEST(CodesErrorsTest, SizeThatCannotExistIsRefused) {
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  const std::string given = "got " + std::to_string(most);
  EXPECT_TRUE(Refuses([&] { this->codes_.Reserve(most); },
                      {"Codes", "size: expected at most", "objects", given}));
  CodedWorld<typename TypeParam::View, typename TypeParam::Code> world;
  EXPECT_TRUE(Refuses([&] { world.Reserve(most); },
                      {"size: expected at most", "objects", given}));
  auto view = this->world_.view();
  view.size = most;
  EXPECT_TRUE(Refuses([&] { this->codes_.Recode(view); },
                      {"Codes", "size: expected at most", "objects", given}));
  this->ExpectUnchanged();
}

TYPED_TEST(CodesErrorsTest, ViewOfNothingNeedsNoPlanes) {
  using View = typename TypeParam::View;
  this->codes_.Recode(View());
  EXPECT_TRUE(this->codes_.empty());
  EXPECT_TRUE(this->codes_.Fits());
  EXPECT_EQ(CountSurvivors(Confirmed(this->codes_, View()),
                           View::Query::Everything()),
            0u);
}

TYPED_TEST(CodesErrorsTest, ConfirmedSizesMustAgree) {
  auto floats = this->world_.view();
  for (std::size_t size : {0u, 129u, 131u}) {
    floats.size = size;
    this->ExpectAllRefuse(Confirmed(this->codes_, floats),
                          "world: ", "as many floats as codes, 130",
                          std::to_string(size));
  }
}

TYPED_TEST(CodesErrorsTest, ConfirmingPlanesAreChecked) {
  using View = typename TypeParam::View;
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    auto floats = this->world_.view();
    PlaneOf(floats, p) = nullptr;
    const bool is_min = IsMinPlane<View>(p);
    this->ExpectAllRefuse(Confirmed(this->codes_, floats),
                          (is_min ? "world.min[" : "world.max[") +
                              std::to_string(is_min ? p : p - kMinima<View>) +
                              "]: ",
                          "a plane of 130 floats", "a null pointer");
  }
}

// Outputs may overlap neither the codes nor the floats that confirm them.
TYPED_TEST(CodesErrorsTest, OutputOverConfirmingPlanesIsRefused) {
  using View = typename TypeParam::View;
  const auto query = View::Query::Everything();
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    View view = this->world_.view();
    auto* plane = const_cast<float*>(PlaneOf(view, p));
    const std::span<std::uint64_t> mask(
        reinterpret_cast<std::uint64_t*>(plane + 64), 3);
    EXPECT_TRUE(Refuses(
        [&] { RejectMask(Confirmed(this->codes_, view), query, mask); },
        {"RejectMask: mask: expected", "apart", "an overlap with world."}));
  }
  const auto* codes = this->codes_.view().planes().planes().plane(0);
  const std::span<std::uint64_t> mask(
      reinterpret_cast<std::uint64_t*>(
          const_cast<
              std::remove_const_t<std::remove_reference_t<decltype(*codes)>>*>(
              codes)),
      3);
  EXPECT_TRUE(
      Refuses([&] { RejectMask(this->codes_, query, mask); },
              {"RejectMask: mask: expected", "apart", "overlap with world."}));
  this->ExpectUnchanged();
}

}  // namespace
}  // namespace halfspace::testing
