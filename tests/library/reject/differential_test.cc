// Every target, schedule and call against the oracle, bit for bit: of one query
// in worlds of every size, of many queries, and of parts of worlds. Nothing is
// read or written beyond the planes, the queries and the outputs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "dispatch/scan/chunks.h"
#include "halfspace/reject_many.h"
#include "halfspace/reject_shapes.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/sizes.h"

#if defined(__unix__)
#include "tests/library/support/guarded_memory.h"
#endif

namespace halfspace::testing {
namespace {

class DifferentialTest : public ::testing::TestWithParam<FlatCase> {
 protected:
  static constexpr std::size_t kMostGuarded =
      2 * 4096 + 5 * 64 + 37;  // objects
  static constexpr std::size_t kMostQueries = 259;

  // An input without both answers would test little.
  void TearDown() override {
    EXPECT_GT(survivors_, 0u);
    EXPECT_LT(survivors_, tests_);
  }

  // More than one vector of misalignments, also where a vector is one lane.
  static std::size_t Misalignments() {
    return std::max<std::size_t>(4, MostLanes());
  }

  // Checks `offsets` misalignments of one size.
  void Check(const FlatInput& input, const AnyQueries& queries,
             std::size_t size, std::size_t offsets = 1,
             const Range& range = {}) {
    for (std::size_t i = 0; i < offsets; ++i) {
      // From one size to the next other ones, when not all are checked.
      const std::size_t offset = (5 * size + i) % Misalignments();
      const AnyWorld world = input.WorldAt(offset, size, Misalignments());
      const Answers answers = Answers::OfReference(world, queries, range);
      survivors_ += answers.survivors().size();
      tests_ += size * queries.count;
      ASSERT_TRUE(AnswersEverywhere(answers, world, queries, targets_))
          << size << " objects, " << queries.count << " queries, offset "
          << offset << ", range " << range.begin << ", " << range.end;
    }
  }

#if defined(__unix__)
  struct Guarded {
    Guarded() {
      for (std::size_t p = 0; p < 10; ++p) {
        planes.emplace_back(kMostGuarded * sizeof(double));
      }
      for (std::size_t o = 0; o < 4; ++o) {
        outputs.emplace_back(kMostQueries * kMostGuarded *
                             sizeof(std::uint32_t));
      }
    }
    std::deque<GuardedMemory> planes;
    GuardedMemory queries{kMostQueries * 10 * sizeof(double)};
    std::deque<GuardedMemory> outputs;
  };

  // Each target keeps the same objects.
  void CheckHalfSpaces(const AnyWorld& world, const GuardedMemory& memory,
                       GuardedSide side) const {
    // Normals and offsets.
    const std::vector<float> values =
        GetParam().layout.dims == 2
            ? std::vector<float>{1, 0, 0, 0.5f, -1, 1}
            : std::vector<float>{1, 0, 0, 0, 0.5f, -1, 0, 1};
    const auto survivors = [&](std::span<std::uint64_t> mask, Target target) {
      detail::Ask(detail::ShapeScan{world.Asked({}), values.data(), 2},
                  "SurvivorMask", [&](detail::Scan&& scan) {
                    detail::SurvivorMask(std::move(scan), mask,
                                         {.target = target});
                  });
    };
    std::vector<std::uint64_t> expected(MaskWords(world.size()));
    survivors(expected, targets_.back());
    const auto mask = memory.Get<std::uint64_t>(expected.size(), side);
    for (Target target : targets_) {
      survivors(mask, target);
      ASSERT_TRUE(std::equal(expected.begin(), expected.end(), mask.begin()))
          << world.size() << " objects, " << target.name();
    }
  }

  // With planes, queries and outputs in mappings of their own, each right
  // beside a page that faults.
  void CheckGuarded(const FlatInput& input, const AnyQueries& given,
                    std::size_t size, const Range& range = {}) {
    if (!guarded_) guarded_ = std::make_unique<Guarded>();
    const std::size_t bytes = given.count * GetParam().query_bytes();
    for (GuardedSide side : {GuardedSide::kBefore, GuardedSide::kAfter}) {
      PlanePointers pointers{};
      for (std::size_t p = 0; p < GetParam().layout.plane_count; ++p) {
        const auto plane = guarded_->planes[p].Get<std::byte>(
            size * GetParam().scalar_bytes(), side);
        std::copy_n(input.Plane(p).begin(), plane.size(), plane.begin());
        pointers[p] = plane.data();
      }
      const AnyWorld world = GetParam().world(pointers, size);
      const auto records = guarded_->queries.Get<std::byte>(bytes, side);
      std::copy_n(static_cast<const std::byte*>(given.records), bytes,
                  records.begin());
      const AnyQueries queries(records.data(), given.count);
      const Answers answers = Answers::OfReference(world, queries, range);
      const std::size_t pairs = answers.survivors().size();
      const auto& memory = guarded_->outputs;
      const Outputs outputs = {
          memory[0].Get<std::uint64_t>(answers.rejected().size(), side),
          memory[1].Get<std::uint32_t>(pairs, side),
          memory[2].Get<std::uint32_t>(pairs, side),
          memory[3].Get<std::size_t>(queries.count, side)};
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
      if (!GetParam().is_double && GetParam().layout.dims <= 3) {
        CheckHalfSpaces(world, memory[0], side);
      }
    }
  }

  std::unique_ptr<Guarded> guarded_;
#else
  void CheckGuarded(const FlatInput&, const AnyQueries&, std::size_t,
                    const Range& = {}) {}
#endif

  // Checks `offsets` misalignments of all sizes of the first `kinds` kinds of
  // input.
  void CheckKinds(const std::vector<std::size_t>& sizes, std::size_t offsets,
                  std::size_t kinds) {
    for (std::size_t k = 0; k < kinds; ++k) {
      const InputKind kind = kInputKinds[k];
      SCOPED_TRACE(NameOf(kind));
      Random random(k);
      const FlatInput input(GetParam(), kind, sizes.back() + Misalignments(),
                            random);
      const bool is_guarded =
          kind == InputKind::kMixed || kind == InputKind::kRuns;
      for (std::size_t size : sizes) {
        Check(input, input.query(), size, offsets);
        if (is_guarded && size <= kMostGuarded) {
          CheckGuarded(input, input.query(), size);
        }
        if (HasFatalFailure()) return;
      }
    }
  }

 private:
  std::vector<Target> targets_ = TargetsUnderTest();
  std::size_t survivors_ = 0;
  std::size_t tests_ = 0;
};

TEST_P(DifferentialTest, EverySmallSizeAtEveryMisalignment) {
  CheckKinds(EverySmallSize(), Scaled(Misalignments()), kInputKinds.size());
}

TEST_P(DifferentialTest, SizesAroundTiles) {
  CheckKinds(SizesAroundTiles(), Scaled(2), kInputKinds.size());
}

TEST_P(DifferentialTest, SizesFromMemory) {
  CheckKinds(SizesFromMemory(GetParam().query_bytes()), 1,
             Scaled(kInputKinds.size()));
}

// Each region has its density of survivors: Schedule::kAuto goes up and down
// through its steps, and each of them, and each change, must keep the bits.
TEST_P(DifferentialTest, WhereTheDensityChanges) {
  constexpr std::size_t kObjects = 9 * kObjectsOfRegion;
  Random random(7);
  const FlatInput input(GetParam(), InputKind::kRegions,
                        kObjects + Misalignments(), random);
  const FlatQueries queries(GetParam(), input, 5, random);
  for (std::size_t begin : {std::size_t{0}, std::size_t{1}, kObjects - 1000}) {
    Check(input, input.query(), kObjects, 1, {.begin = begin});
    Check(input, queries.Some(0, 5), kObjects, 1, {.begin = begin});
    if (HasFatalFailure()) return;
  }
}

// Around the registers that share a load (2 or 4 queries), the rows of a tile
// (16) and the queries that are ready at a time (256).
TEST_P(DifferentialTest, EveryNumberOfQueries) {
  for (std::size_t seed = 0; seed < Scaled(4); ++seed) {
    const InputKind kind =
        seed % 2 == 0 ? InputKind::kAdversarial : InputKind::kMixed;
    SCOPED_TRACE(::testing::Message() << NameOf(kind) << ", seed " << seed);
    Random random(seed);
    const FlatInput input(GetParam(), kind, 2 * 64 + 31 + Misalignments(),
                          random);
    const FlatQueries queries(GetParam(), input, 601, random);
    for (std::size_t size : {0, 1, 63, 64, 65, 2 * 64 + 31}) {
      for (std::size_t count :
           {0, 1, 2, 3, 4, 5, 7, 8, 9, 16, 17, 255, 256, 257, 600}) {
        // From the second on: aligned to no more than a value is.
        const AnyQueries some = queries.Some(1, count);
        Check(input, some, size);
        if (seed == 0 && count <= kMostQueries) CheckGuarded(input, some, size);
        if (HasFatalFailure()) return;
      }
    }
    // Every length of the last word.
    for (std::size_t size = 0; seed == 0 && size <= 64 + MostLanes(); ++size) {
      CheckGuarded(input, queries.Some(0, 7), size);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(DifferentialTest, ManyQueriesAroundTiles) {
  for (InputKind kind : {InputKind::kRuns, InputKind::kDense}) {
    SCOPED_TRACE(NameOf(kind));
    Random random(7);
    const FlatInput input(GetParam(), kind, 10'000, random);
    const FlatQueries queries(GetParam(), input, 300, random);
    const std::size_t tile = dispatch::ChunkObjects(
        input.WorldAt(0, 5000, 1).Asked(queries.Some(0, 2)));
    ASSERT_GE(tile, 64u);
    ASSERT_LE(2 * tile + 65 + Misalignments(), 10'000u);
    ASSERT_EQ(tile % 64, 0u);
    for (std::size_t size : {tile - 1, tile, tile + 1, 2 * tile + 65}) {
      for (std::size_t count : {2, 5, 17}) {
        Check(input, queries.Some(0, count), size);
        if (HasFatalFailure()) return;
      }
    }
    // A second block, of which the world is read again.
    Check(input, queries.Some(0, 259), tile + 1);
    if (HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(, DifferentialTest,
                         ::testing::ValuesIn(AllFlatCases()),
                         ::testing::PrintToStringParamName());

class RangeTest : public DifferentialTest {
 protected:
  static constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t kQueries =
      7;  // tiles of registers, and one more

  void CheckRanges(std::size_t size, std::span<const Range> ranges) {
    Random random(size);
    const FlatInput input(GetParam(), InputKind::kMixed, size + Misalignments(),
                          random);
    const FlatQueries queries(GetParam(), input, kQueries, random);
    for (const Range& range : ranges) {
      Check(input, queries.Some(0, 1), size, 1, range);
      Check(input, queries.Some(0, kQueries), size, 1, range);
      // Of a large world, ranges of more than a tile.
      if (size > 4096) CheckGuarded(input, queries.Some(0, 5), size, range);
      if (HasFatalFailure()) return;
    }
  }
};

// Ranges within words and across them, and what lies past the world.
TEST_P(RangeTest, EveryRangeOfASmallWorld) {
  for (std::size_t size : {0, 1, 64, 3 * 64 + 37}) {
    std::vector<std::size_t> ends = {size, size + 1, kMost};
    const std::size_t past = (MaskWords(size) + 2) * 64;
    for (std::size_t end = 0; end <= past; end += 64) {
      ends.insert(ends.end(), {end, end + 1, end + 13, end + 63});
    }
    std::vector<Range> ranges;
    for (std::size_t begin :
         {0u, 1u, 3u, 16u, 63u, 64u, 101u, 128u, 4u * 64u}) {
      for (std::size_t end : ends) {
        if (begin <= end) ranges.push_back({begin, end});
      }
    }
    CheckRanges(size, ranges);
    if (HasFatalFailure()) return;
  }
}

// Tiles begin where the range does.
TEST_P(RangeTest, RangesAcrossTiles) {
  constexpr std::size_t kSize = 2 * 4096 + 5 * 64 + 37;
  const std::vector<Range> ranges = {
      {65, 4096 + 128}, {4031, kSize},           {64, 4096},
      {63, 4096 + 64},  {2 * 4096 + 319, kMost}, {4096, 2 * 4096 + 1},
      {0, 2 * 4096},    {511, 2 * 4096}};
  CheckRanges(kSize, std::span(ranges).first(
                         std::min(Scaled(ranges.size()), ranges.size())));
}

INSTANTIATE_TEST_SUITE_P(, RangeTest, ::testing::ValuesIn(AllFlatCases()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace halfspace::testing
