// Owning worlds and quantized bounds against a plain vector of bounds.
#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/expect_invalid.h"
#include "tests/library/world/owner_inputs.h"

namespace halfspace::testing {
namespace {

TEST_P(OwnerTest, RandomOperationsFollowTheModel) { FollowModel(Scaled(2500)); }

TEST_P(OwnerTest, IndexPastTheEndIsRefused) {
  const Records model = RandomBounds(130);
  const auto owner = row_.Make(model);
  for (std::size_t index : {std::size_t{130}, ~std::size_t{0}}) {
    const std::string given = "got " + std::to_string(index);
    const auto refused = [&](const char* call, const auto& make_call) {
      EXPECT_TRUE(Refuses(make_call,
                          {row_.type, "::", call, ": ",
                           "index: expected less than the size, 130", given}));
    };
    Record bound = model[0];
    if (owner->Get(0, bound)) {
      refused("Get", [&] { owner->Get(index, bound); });
    }
    refused("Set", [&] { owner->Set(index, bound); });
    refused("EraseBySwap", [&] { owner->EraseBySwap(index); });
  }
  ExpectHolds(*owner, model);
}

TEST_P(OwnerTest, ListThatCannotBeReadIsRefused) {
  const Records model = RandomBounds(70);
  const auto owner = row_.Make(model);
  const std::vector<std::byte> list = row_.List(model);
  const auto refused = [&](const void* bounds, std::size_t count,
                           std::string_view expected, std::string_view given) {
    for (bool is_new : {false, true}) {
      EXPECT_TRUE(Refuses(
          [&] {
            if (is_new) {
              row_.make(bounds, count, {});
            } else {
              owner->Assign(bounds, count);
            }
          },
          {row_.IsQuantized() ? "QuantizedBounds" : "World", expected, "got",
           given}));
    }
    ExpectHolds(*owner, model);
  };
  refused(nullptr, 3, "bounds: expected memory for 3 elements",
          "a null pointer");
  refused(Misaligned(list.data()), 3, "bounds: expected a pointer aligned to",
          "a misaligned one");
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  refused(list.data(), most, "size: expected at most", std::to_string(most));
  EXPECT_TRUE(Refuses([&] { owner->Reserve(most); },
                      {"size: expected at most", "objects, got"}));
  ExpectHolds(*owner, model);
  owner->Assign(nullptr, 0);
  ExpectHolds(*owner, {});
}

INSTANTIATE_TEST_SUITE_P(, OwnerTest, ::testing::ValuesIn(OwnerRows()),
                         ::testing::PrintToStringParamName());

// The constructors that take views and worlds, and what they refuse.
TEST(QuantizedOwnerTest, FromViewsAndWorlds) {
  const std::vector<Aabb3> bounds(130, Aabb3{{1, 1, 1}, {2, 2, 2}});
  const AabbWorld3 floats(bounds);
  const Aabb3 query{{2, 0, 0}, {3, 1, 1}};
  const QuantizedBounds quantized(floats);
  static_assert(
      std::is_same_v<decltype(quantized), const QuantizedBounds<AabbView3>>);
  EXPECT_EQ(CountSurvivors(Refined(quantized, floats), query), 130u);
  EXPECT_EQ(CountSurvivors(Refined(quantized, floats.view()), query), 130u);
  EXPECT_EQ(CountSurvivors(QuantizedWorld<AabbView3>(floats), query), 130u);
  EXPECT_EQ(CountSurvivors(QuantizedWorld<AabbView3>(floats.view()), query),
            130u);
  QuantizedBounds<AabbView3> changed = quantized;
  for (std::size_t p = 0; p < 6; ++p) {
    const std::string name = "QuantizedBounds::Requantize: floats, plane " +
                             std::to_string(p) + ": expected";
    const float* const none = nullptr;
    AabbView3 view = floats.view();
    const float* const plane = PlaneOf(view, p);
    for (const float* bad : {none, Misaligned(plane)}) {
      PlaneOf(view, p) = bad;
      EXPECT_TRUE(Refuses(
          [&] { changed.Requantize(view); },
          {name, bad == none ? "a plane of 130 floats" : "aligned to 4 bytes",
           bad == none ? "got a null pointer" : "got a misaligned one"}));
      EXPECT_TRUE(
          Refuses([&] { QuantizedWorld<AabbView3> world(view); }, {name}));
    }
  }
  AabbView3 view = floats.view();
  view.size = std::numeric_limits<std::size_t>::max();
  EXPECT_TRUE(Refuses([&] { changed.Requantize(view); },
                      {"QuantizedBounds", "size: expected at most"}));
  EXPECT_EQ(CountSurvivors(Refined(changed, floats), query), 130u);
  // A view of nothing needs no planes.
  changed.Requantize(AabbView3());
  EXPECT_TRUE(changed.empty() && changed.Fits());
  EXPECT_EQ(CountSurvivors(Refined(changed, AabbView3()), query), 0u);
}

}  // namespace
}  // namespace halfspace::testing
