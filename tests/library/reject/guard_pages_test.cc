// Nothing is read or written beyond the planes and the outputs: each of them
// lies in a mapping of its own, right beside a page that faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/reject_shapes.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/guarded_memory.h"
#include "tests/library/support/inputs.h"
#include "tests/library/support/sizes.h"

namespace halfspace::testing {
namespace {

// The memory itself must be what the tests rely on.
TEST(GuardedMemoryDeathTest, FaultsOneElementFromEitherGuard) {
  const GuardedMemory memory(1);
  const auto touch = [](const float* value) {
    return *const_cast<const volatile float*>(value);
  };
  const float* first = memory.Get<float>(3, GuardedSide::kBefore).data();
  const float* last = memory.Get<float>(3, GuardedSide::kAfter).data() + 2;
  EXPECT_EQ(touch(first), 0.f);
  EXPECT_EQ(touch(last), 0.f);
  EXPECT_DEATH(touch(first - 1), "");
  EXPECT_DEATH(touch(last + 1), "");
}

template <typename Case>
class GuardPagesTest : public ::testing::Test {
 protected:
  using Stored = typename Case::Stored;
  using Scalar = ScalarOf<Stored>;

  GuardPagesTest() {
    for (auto& plane : planes_) {
      plane = std::make_unique<GuardedMemory>(kMostObjects * sizeof(Scalar));
    }
  }

  static constexpr std::size_t kMostObjects = 2 * 4096;

  void Check(const Input<Stored>& input, std::size_t size, GuardedSide side) {
    Stored stored;
    for (std::size_t p = 0; p < kPlanes<Stored>; ++p) {
      const auto plane = planes_[p]->template Get<Scalar>(size, side);
      std::copy_n(input.planes[p].begin(), size, plane.begin());
      PlaneOf(stored, p) = plane.data();
    }
    stored.size = size;
    const auto view = Case::Seen(stored);
    const auto query = Case::Seen(input.query);
    const Answer answer = ReferenceAnswer(view, query);
    const Outputs outputs = {
        mask_.Get<std::uint64_t>(answer.reject_mask().size(), side),
        indices_.Get<std::uint32_t>(answer.survivors().size(), side)};
    for (Target target : targets_) {
      for (Schedule schedule : kSchedules) {
        ASSERT_TRUE(Answers(answer, view, query,
                            {.schedule = schedule, .target = target}, outputs))
            << size << " objects";
      }
    }
    using View = std::remove_cvref_t<decltype(view.view())>;
    constexpr int kDims = View::Bound::kDimensions;
    if constexpr (std::is_same_v<Scalar, float> && kDims <= 3) {
      CheckHalfSpaces<kDims>(view, side);
    }
  }

  // Each target keeps the same objects.
  template <int kDims, typename View>
  void CheckHalfSpaces(const View& view, GuardedSide side) {
    HalfSpace<kDims> half_spaces[2] = {};
    half_spaces[0].normal[0] = 1;
    half_spaces[1].normal[1] = -1;
    half_spaces[1].normal[0] = 0.5f;
    half_spaces[1].offset = 1;
    const std::size_t words = MaskWords(view.size);
    std::vector<std::uint64_t> expected(words);
    SurvivorMask(view, half_spaces, expected, {.target = targets_.back()});
    const auto mask = mask_.Get<std::uint64_t>(words, side);
    for (Target target : targets_) {
      SurvivorMask(view, half_spaces, mask, {.target = target});
      ASSERT_TRUE(std::equal(expected.begin(), expected.end(), mask.begin()))
          << view.size << " objects, " << target.name();
    }
  }

  void CheckSizes(const std::vector<std::size_t>& sizes) {
    Random random(2);
    for (InputKind kind : {InputKind::kMixed, InputKind::kRuns}) {
      const auto input = MakeInput<Stored>(kind, sizes.back(), random);
      for (std::size_t size : sizes) {
        for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
          Check(input, size, side);
          if (this->HasFatalFailure()) return;
        }
      }
    }
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  std::unique_ptr<GuardedMemory> planes_[kPlanes<Stored>];
  GuardedMemory mask_{MaskWords(kMostObjects) * sizeof(std::uint64_t)};
  GuardedMemory indices_{kMostObjects * sizeof(std::uint32_t)};
};

TYPED_TEST_SUITE(GuardPagesTest, AllCases, CaseNames);

TYPED_TEST(GuardPagesTest, EverySmallSize) {
  this->CheckSizes(EverySmallSize());
}

TYPED_TEST(GuardPagesTest, SizesAroundTiles) {
  this->CheckSizes({4096, 4096 + 64 + 1, 2 * 4096 - 1});
}

// The gap after the last point of a stride need not exist.
TEST(GuardPagesFitTest, PointsEndAtAGuardPage) {
  constexpr std::size_t kStride = 5;
  const GuardedMemory memory(100 * kStride * sizeof(float));
  for (std::size_t count = 1; count < 100; ++count) {
    const std::size_t floats = (count - 1) * kStride + 3;
    for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
      const auto coords = memory.Get<float>(floats, side);
      std::fill(coords.begin(), coords.end(), 1.f);
      EXPECT_EQ(BoundPoints<3>({coords.data(), count, kStride}),
                (Aabo3{{1, 1, 1, -3}, {1, 1, 1, -3}}));
    }
  }
}

}  // namespace
}  // namespace halfspace::testing
