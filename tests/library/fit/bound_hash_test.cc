// One constant per builder that stands for its bounds of many seeded shapes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/library/fit/builders.h"
#include "tests/library/support/fnv_hash.h"
#include "tests/library/support/known_hashes.h"
#include "tests/library/support/seeded_numbers.h"

namespace halfspace::testing {
namespace {

class BoundHashTest : public ::testing::TestWithParam<Builder> {};

TEST_P(BoundHashTest, IsTheSameEverywhere) {
  constexpr int kBounds = 1000;
  const Builder& builder = GetParam();
  SeededNumbers numbers(11);
  FnvHash hash;
  int unbounded = 0;
  for (int i = 0; i < kBounds; ++i) {
    const Planes planes = builder.Build(SeededShape(builder, numbers));
    unbounded += planes == builder.Everything();
    for (float plane : planes) ASSERT_FALSE(std::isnan(plane)) << i;
    hash.AddAllFloats(planes);
  }
  EXPECT_LT(unbounded, kBounds / 2);
  EXPECT_TRUE(IsKnown(builder.name, hash.value()));
}

INSTANTIATE_TEST_SUITE_P(, BoundHashTest,
                         ::testing::ValuesIn(BuildersAndChanges()),
                         BuilderNames());

}  // namespace
}  // namespace halfspace::testing
