// What calls on quantized bounds refuse: floats that do not refine them, and
// outputs within either. (Owners refuse in world/owner_test.cc.)
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "halfspace/quantized.h"
#include "halfspace/reject.h"
#include "tests/library/support/calls.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/expect_invalid.h"

namespace halfspace::testing {
namespace {

template <typename View, typename Element>
void ExpectAllRefuse(const QuantizedBounds<View, Element>& quantized,
                     const View& floats, std::string_view argument,
                     std::string_view expected, std::string_view given) {
  const auto query = View::Query::Everything();
  const AnyWorld refined(Refined(quantized, floats));
  const auto refuses = [&](std::string_view name, const auto& call) {
    EXPECT_TRUE(Refuses(call, {"halfspace: ", name, argument, "expected",
                               expected, "got", given}));
  };
  CallOutputs outputs;
  ForEachCall(refined, {&query, 1}, {}, outputs, refuses);
  EXPECT_TRUE(outputs.Untouched());
  ForEachManyCall(refined, {&query, 1}, {}, outputs, refuses);
  EXPECT_TRUE(outputs.Untouched());
}

template <typename View, typename Element>
void CheckRefined() {
  using Bound = typename View::Bound;
  const World<View> world(std::vector<Bound>(130, Bound::Everything()));
  const QuantizedBounds<View, Element> quantized(world);
  const auto query = View::Query::Everything();
  for (std::size_t size : {0u, 129u, 131u}) {
    View floats = world.view();
    floats.size = size;
    ExpectAllRefuse(quantized, floats,
                    "world: ", "as many floats as quantized bounds, 130",
                    std::to_string(size));
  }
  const auto expect_overlap = [&](const auto& any_world, const void* in) {
    const std::span<std::uint64_t> mask(
        static_cast<std::uint64_t*>(const_cast<void*>(in)), 3);
    EXPECT_TRUE(Refuses(
        [&] { RejectMask(any_world, query, mask); },
        {"RejectMask: mask: expected", "apart", "overlap with world."}));
  };
  for (std::size_t p = 0; p < kPlanes<View>; ++p) {
    View floats = world.view();
    expect_overlap(Refined(quantized, floats), PlaneOf(floats, p) + 64);
    PlaneOf(floats, p) = nullptr;
    const bool is_min = IsMinPlane<View>(p);
    ExpectAllRefuse(quantized, floats,
                    (is_min ? "world.min[" : "world.max[") +
                        std::to_string(is_min ? p : p - kMinima<View>) + "]: ",
                    "a plane of 130 floats", "a null pointer");
  }
  expect_overlap(quantized, quantized.view().planes[0]);
}

TEST(QuantizedErrorsTest, FloatsThatDoNotRefineAndOutputsWithin) {
  CheckRefined<SimplexView3, std::uint8_t>();
  CheckRefined<AabbView3, std::uint16_t>();
  CheckRefined<AaboView3, std::uint8_t>();
}

}  // namespace
}  // namespace halfspace::testing
