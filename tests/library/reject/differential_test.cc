// Every target, schedule and output form against the oracle, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "tests/library/support/answers.h"
#include "tests/library/support/canaries.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

template <typename Case>
class DifferentialTest : public ::testing::Test {
 protected:
  using Stored = typename Case::Stored;

  // More than one vector of misalignments, also where a vector is one lane.
  static std::size_t Misalignments() {
    return std::max<std::size_t>(4, MostLanes());
  }

  // Checks `offsets` misalignments of one size.
  void Check(const Input<Stored>& input, std::size_t size,
             std::size_t offsets) {
    const auto query = Case::Seen(input.query);
    for (std::size_t i = 0; i < offsets; ++i) {
      // From one size to the next other ones, when not all are checked.
      const std::size_t offset = (5 * size + i) % Misalignments();
      const auto view =
          Case::Seen(ViewAt(input, offset, size, Misalignments()));
      answer_.AssignReference(view, query);
      survivors_ += answer_.survivors().size();
      objects_ += size;
      ASSERT_TRUE(AnswersEverywhere(answer_, view, query, targets_))
          << size << " objects, offset " << offset;
    }
  }

  // Checks `offsets` misalignments of all sizes of the first `kinds` kinds of
  // input.
  void CheckKinds(const std::vector<std::size_t>& sizes, std::size_t offsets,
                  std::size_t kinds) {
    for (std::size_t k = 0; k < kinds; ++k) {
      const InputKind kind = kInputKinds[k];
      SCOPED_TRACE(NameOf(kind));
      Random random(1);
      const auto input =
          MakeInput<Stored>(kind, sizes.back() + Misalignments(), random);
      for (std::size_t size : sizes) {
        Check(input, size, offsets);
        if (HasFatalFailure()) return;
      }
    }
    ExpectBothAnswers();
  }

  // An input without both answers would test little.
  void ExpectBothAnswers() const {
    EXPECT_GT(survivors_, 0u);
    EXPECT_LT(survivors_, objects_);
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  Answer answer_;
  std::size_t survivors_ = 0;
  std::size_t objects_ = 0;
};

TYPED_TEST_SUITE(DifferentialTest, AllCases, CaseNames);

TYPED_TEST(DifferentialTest, EverySmallSizeAtEveryMisalignment) {
  const std::vector<std::size_t> sizes = EverySmallSize();
  const std::size_t offsets = Scaled(this->Misalignments());
  for (InputKind kind : kInputKinds) {
    for (std::size_t seed = 0; seed < Scaled(4); ++seed) {
      SCOPED_TRACE(::testing::Message() << NameOf(kind) << ", seed " << seed);
      Random random(seed);
      const auto input = MakeInput<typename TypeParam::Stored>(
          kind, sizes.back() + this->Misalignments(), random);
      for (std::size_t size : sizes) {
        this->Check(input, size, offsets);
        if (this->HasFatalFailure()) return;
      }
    }
  }
  this->ExpectBothAnswers();
}

TYPED_TEST(DifferentialTest, SizesAroundTiles) {
  this->CheckKinds(SizesAroundTiles(), Scaled(2), kInputKinds.size());
}

TYPED_TEST(DifferentialTest, SizesFromMemory) {
  const auto query = TypeParam::Seen(typename TypeParam::Stored::Query());
  this->CheckKinds(SizesFromMemory(sizeof(query)), 1,
                   Scaled(kInputKinds.size()));
}

}  // namespace
}  // namespace halfspace::testing
