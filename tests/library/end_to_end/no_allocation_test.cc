// Builders and calls allocate nothing, as they say: there is no memory left.
#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "halfspace/halfspace.h"
#include "tests/library/fit/every_builder.h"
#include "tests/library/fit/random_every_shape.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/dims.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/five_calls.h"
#include "tests/library/support/limited_memory.h"
#include "tests/library/support/many_calls.h"
#include "tests/library/support/quantized_cases.h"

namespace halfspace::testing {
namespace {

// The calls on `world`, for one query and for many.
template <typename AnyWorld>
void ExpectCallsWithoutMemory(
    const AnyWorld& world,
    const std::vector<typename AnyWorld::Query>& queries) {
  const auto visit = [](auto, const auto& call) { kWithoutMemory(call); };
  CallOutputs outputs;
  ManyCallOutputs many_outputs;
  for (Target target : TargetsUnderTest()) {
    const Options options{.target = target};
    ForEachCall(world, queries[0], options, outputs, visit);
    ForEachManyCall(world, std::span(queries), options, many_outputs, visit);
  }
}

template <typename Dims>
class NoAllocationTest : public ::testing::Test {};
TYPED_TEST_SUITE(NoAllocationTest, AllDims, DimsNames);

TYPED_TEST(NoAllocationTest, Builders) {
  Random random(61);
  for (PointKind kind : kPointKinds) {
    const auto shape = RandomEveryShape<TypeParam::value>(kind, random);
    VisitEveryBuilder(shape, TargetsUnderTest(), kWithoutMemory);
  }
}

template <typename Case>
class NoAllocationOfCallsTest : public ::testing::Test {};
TYPED_TEST_SUITE(NoAllocationOfCallsTest, FewQuantizedCases,
                 QuantizedCaseNames);

TYPED_TEST(NoAllocationOfCallsTest, OnFloatsAndQuantized) {
  using View = typename TypeParam::View;
  Random random(62);
  auto bounds =
      MakeQuantizedBounds<View>(QuantizedInputKind::kUniform, 1000, random);
  std::vector<typename View::Query> queries;
  for (int i = 0; i < 9; ++i) {
    queries.push_back(MakeQuantizedQuery<View>(bounds, random));
  }
  const World<View> floats(bounds);
  const QuantizedWorld<View, typename TypeParam::Element> quantized_world{
      std::span(bounds)};
  ExpectCallsWithoutMemory(floats, queries);
  ExpectCallsWithoutMemory(quantized_world.quantized(), queries);
  ExpectCallsWithoutMemory(Refined(quantized_world.quantized(), floats.view()),
                           queries);
  ExpectCallsWithoutMemory(quantized_world, queries);
}

}  // namespace
}  // namespace halfspace::testing
