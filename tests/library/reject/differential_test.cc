// Every target, schedule and output form against the oracle, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

class DifferentialTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  // More than one vector of misalignments, also where a vector is one lane.
  static std::size_t Misalignments() {
    return std::max<std::size_t>(4, MostLanes());
  }

  // Checks `offsets` misalignments of one size.
  void Check(const FlatInput& input, std::size_t size, std::size_t offsets) {
    for (std::size_t i = 0; i < offsets; ++i) {
      // From one size to the next other ones, when not all are checked.
      const std::size_t offset = (5 * size + i) % Misalignments();
      const AnyWorld world = input.WorldAt(offset, size, Misalignments());
      answer_.AssignReference(world, input.query());
      survivors_ += answer_.survivors().size();
      objects_ += size;
      ASSERT_TRUE(AnswersEverywhere(answer_, world, input.query(), targets_))
          << size << " objects, offset " << offset;
    }
  }

  // Checks `offsets` misalignments of all sizes of the first `kinds` kinds of
  // input, each of `seeds` seeds.
  void CheckKinds(const std::vector<std::size_t>& sizes, std::size_t offsets,
                  std::size_t kinds, std::size_t seeds = 1) {
    for (std::size_t k = 0; k < kinds; ++k) {
      for (std::size_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(::testing::Message()
                     << NameOf(kInputKinds[k]) << ", seed " << seed);
        Random random(seed);
        const FlatInput input(GetParam(), kInputKinds[k],
                              sizes.back() + Misalignments(), random);
        for (std::size_t size : sizes) {
          Check(input, size, offsets);
          if (HasFatalFailure()) return;
        }
      }
    }
    // An input without both answers would test little.
    EXPECT_GT(survivors_, 0u);
    EXPECT_LT(survivors_, objects_);
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  Answer answer_;
  std::size_t survivors_ = 0;
  std::size_t objects_ = 0;
};

TEST_P(DifferentialTest, EverySmallSizeAtEveryMisalignment) {
  CheckKinds(EverySmallSize(), Scaled(Misalignments()), kInputKinds.size(),
             Scaled(4));
}

TEST_P(DifferentialTest, SizesAroundTiles) {
  CheckKinds(SizesAroundTiles(), Scaled(2), kInputKinds.size());
}

TEST_P(DifferentialTest, SizesFromMemory) {
  CheckKinds(SizesFromMemory(GetParam().query_bytes()), 1,
             Scaled(kInputKinds.size()));
}

INSTANTIATE_TEST_SUITE_P(, DifferentialTest,
                         ::testing::ValuesIn(AllFlatCases()), FlatCaseName);

}  // namespace
}  // namespace halfspace::testing
