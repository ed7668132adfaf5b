// Nothing is read or written beyond the planes, the queries and the outputs:
// each of them lies in a mapping of its own, right beside a page that faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "halfspace/fit.h"
#include "halfspace/reject_shapes.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/guarded_memory.h"
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

class GuardPagesTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  static constexpr std::size_t kMostObjects = 2 * 4096 + 37;
  static constexpr std::size_t kMostQueries = 259;

  GuardPagesTest() {
    for (std::size_t p = 0; p < GetParam().stored.plane_count; ++p) {
      planes_.push_back(std::make_unique<GuardedMemory>(
          kMostObjects * GetParam().scalar_bytes()));
    }
  }

  // A world of the first `size` objects of an input.
  AnyWorld WorldOf(const FlatInput& input, std::size_t size,
                   GuardedSide side) const {
    PlanePointers pointers{};
    const std::size_t bytes = size * GetParam().scalar_bytes();
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      const auto plane = planes_[p]->Get<std::byte>(bytes, side);
      std::copy_n(input.Plane(p).begin(), bytes, plane.begin());
      pointers[p] = plane.data();
    }
    return GetParam().world(pointers, size);
  }

  // With queries and outputs in such memory too, and a range of the objects.
  void Check(const FlatInput& input, const AnyQueries& given, std::size_t size,
             const Range& range = {}) {
    const std::size_t bytes = given.count * GetParam().query_bytes();
    for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
      const AnyWorld world = WorldOf(input, size, side);
      const auto records = queries_memory_.Get<std::byte>(bytes, side);
      std::copy_n(static_cast<const std::byte*>(given.records), bytes,
                  records.begin());
      const AnyQueries queries(records.data(), given.count);
      const Answers answers = Answers::OfReference(world, queries, range);
      const std::size_t pairs = answers.survivors().size();
      const Outputs outputs = {
          rows_.Get<std::uint64_t>(answers.rejected().size(), side),
          object_indices_.Get<std::uint32_t>(pairs, side),
          query_indices_.Get<std::uint32_t>(pairs, side),
          counts_.Get<std::size_t>(queries.count, side)};
      for (Target target : targets_) {
        for (Schedule schedule : kSchedules) {
          ASSERT_TRUE(CallsAnswer(
              answers, world, queries,
              {.schedule = schedule, .target = target, .range = range},
              outputs))
              << size << " objects, " << queries.count << " queries, range "
              << range.begin << ", " << range.end;
        }
      }
      if (!GetParam().is_double && GetParam().seen.dims <= 3) {
        CheckHalfSpaces(world, side);
      }
    }
  }

  // Each target keeps the same objects.
  void CheckHalfSpaces(const AnyWorld& world, GuardedSide side) const {
    // Normals and offsets.
    const std::vector<float> values =
        GetParam().seen.dims == 2
            ? std::vector<float>{1, 0, 0, 0.5f, -1, 1}
            : std::vector<float>{1, 0, 0, 0, 0.5f, -1, 0, 1};
    const auto survivors = [&](std::span<std::uint64_t> mask, Target target) {
      detail::SurvivorMask(
          detail::HalfSpaceScan{world.Asked({}), values.data(), 2}, mask,
          {.target = target});
    };
    std::vector<std::uint64_t> expected(MaskWords(world.size()));
    survivors(expected, targets_.back());
    const auto mask = rows_.Get<std::uint64_t>(expected.size(), side);
    for (Target target : targets_) {
      survivors(mask, target);
      ASSERT_TRUE(std::equal(expected.begin(), expected.end(), mask.begin()))
          << world.size() << " objects, " << target.name();
    }
  }

  void CheckSizes(const std::vector<std::size_t>& sizes) {
    Random random(2);
    for (InputKind kind : {InputKind::kMixed, InputKind::kRuns}) {
      const FlatInput input(GetParam(), kind, sizes.back(), random);
      for (std::size_t size : sizes) {
        Check(input, input.query(), size);
        if (HasFatalFailure()) return;
      }
    }
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  std::vector<std::unique_ptr<GuardedMemory>> planes_;
  GuardedMemory queries_memory_{kMostQueries * GetParam().query_bytes()};
  GuardedMemory rows_{kMostQueries * MaskWords(kMostObjects) *
                      sizeof(std::uint64_t)};
  GuardedMemory query_indices_{kMostQueries * kMostObjects *
                               sizeof(std::uint32_t)};
  GuardedMemory object_indices_{kMostQueries * kMostObjects *
                                sizeof(std::uint32_t)};
  GuardedMemory counts_{kMostQueries * sizeof(std::size_t)};
};

TEST_P(GuardPagesTest, EverySmallSize) { CheckSizes(EverySmallSize()); }

TEST_P(GuardPagesTest, SizesAroundTiles) {
  CheckSizes({4096, 4096 + 64 + 1, 2 * 4096 - 1});
}

TEST_P(GuardPagesTest, SeveralQueries) {
  Random random(5);
  const FlatInput input(GetParam(), InputKind::kRuns, kMostObjects, random);
  const FlatQueries queries(GetParam(), input, kMostQueries, random);
  const auto check = [&](std::size_t size, std::size_t count,
                         const Range& range = {}) {
    if (!HasFatalFailure()) Check(input, queries.Some(0, count), size, range);
  };
  // Every length of the last word.
  for (std::size_t size = 0; size <= 64 + MostLanes(); ++size) {
    check(size, 1);
    check(size, 7);
  }
  for (std::size_t count : {0, 1, 2, 3, 4, 5, 8, 15, 16, 17, 255, 256, 259}) {
    check(2 * 64 + 5, count);
  }
  for (const Range& range : {Range{}, Range{61, 4099}, Range{4097, 8229}}) {
    check(kMostObjects, 5, range);
  }
}

INSTANTIATE_TEST_SUITE_P(, GuardPagesTest, ::testing::ValuesIn(AllFlatCases()),
                         FlatCaseName);

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
