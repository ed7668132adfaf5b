// The streaming kernels against the flat ones, and the schedules against each
// other. Calls use these kernels only where StreamingPays(), so they are tested
// here on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/reject_many.h"
#include "kernels/scan/kernel_table.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

using detail::ScanKernel;

// Objects of a unit world, `each` of each half size, one after another.
template <typename T>
class Regions {
 public:
  Regions(const FlatCase& kind, std::span<const float> half_sizes,
          std::size_t each)
      : kind_(kind), planes_(kind.seen.plane_count) {
    Random random(each);
    for (float half_size : half_sizes) {
      for (std::size_t i = 0; i < each; ++i) Push(random, half_size);
    }
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      pointers_[p] = planes_[p].data();
    }
  }

  AnyWorld world() const { return kind_.world(pointers_, planes_[0].size()); }

  // The values of a query with this center on each axis.
  template <typename Center>
  std::vector<T> Query(float half_size, const Center& center) const {
    std::vector<T> query(planes_.size());
    for (std::size_t k = 0; k < kind_.seen.axes; ++k) {
      const T at = center();
      query[kind_.Opposing(k)] = at + half_size;
      if (kind_.seen.has_max) {
        query[kind_.Opposing(k + kind_.seen.axes)] = at - half_size;
      }
    }
    return query;
  }

 private:
  void Push(Random& random, float half_size) {
    std::uniform_real_distribution<float> center(0, 1);
    for (std::size_t k = 0; k < kind_.seen.axes; ++k) {
      const T at = center(random);
      planes_[k].push_back(at - half_size);
      if (kind_.seen.has_max) {
        planes_[k + kind_.seen.axes].push_back(at + half_size);
      }
    }
  }

  const FlatCase& kind_;
  std::vector<std::vector<T>> planes_;
  PlanePointers pointers_{};
};

std::vector<std::uint64_t> WordsOf(const detail::Scan& scan,
                                   ScanKernel kernel) {
  // One word more, which no kernel may touch.
  std::vector<std::uint64_t> words(MaskWords(scan.end - scan.begin) + 1,
                                   0x5555);
  const detail::Chunk chunk{.first_query = 0,
                            .query_count = 1,
                            .queries = scan.queries,
                            .begin = scan.begin,
                            .end = scan.end,
                            .rows = words.data(),
                            .stride = 0};
  scan.kernels->run[kernel](scan, chunk);
  return words;
}

class StreamingTest : public ::testing::TestWithParam<FlatCase> {};

TEST_P(StreamingTest, TestsLikeTheFlatKernel) {
  using Layout = detail::PlaneLayout;
  const FlatCase& kind = GetParam();
  const bool is_simplex = kind.seen.kind == Layout::kSimplex;
  const ScanKernel flat = is_simplex ? ScanKernel::kMinima : ScanKernel::kAll;
  const ScanKernel streaming = is_simplex ? ScanKernel::kMinimaStreaming
                               : kind.seen.kind == Layout::kAabb
                                   ? ScanKernel::kAllStreaming
                                   : ScanKernel::kBySimplex;
  kind.WithScalar([&]<typename T>(T) {
    // Whole pages, parts of one, and tiles of 4096 objects; with and without
    // tail.
    for (std::size_t size : {1u, 64u, 1024u, 1088u, 4096u, 9000u}) {
      // Of the words of a tile few survive, and almost all.
      for (float half_size : {0.02f, 0.2f}) {
        const Regions<T> regions(kind, {&half_size, 1}, size + 1);
        const auto query = regions.Query(half_size, [] { return T{0.5}; });
        const AnyWorld world = regions.world();
        detail::Scan scan = world.Asked({query.data(), 1});
        // Planes are aligned or not.
        for (scan.begin = 0; scan.begin < 2; ++scan.begin) {
          scan.end = scan.begin + size;
          for (Target target : TargetsUnderTest()) {
            scan.kernels = *scan.type->all_kernels +
                           dispatch::IndexOf(target, "streaming_test");
            scan.is_streaming = false;
            const auto expected = WordsOf(scan, flat);
            scan.is_streaming = true;
            EXPECT_EQ(WordsOf(scan, streaming), expected)
                << target.name() << ": " << size << " objects from "
                << scan.begin << ", " << half_size;
          }
        }
      }
    }
  });
}

// A world of regions, each with its density of survivors: kAdaptive goes up and
// down through its steps, and each of them, and each change, must keep the
// bits.
TEST_P(StreamingTest, SchedulesAgreeWhereTheDensityChanges) {
  constexpr float kRegions[] = {0.001f, 0.2f,   0.015f, 0.6f, 0.001f,
                                0.05f,  0.001f, 0.015f, 0.2f};
  GetParam().WithScalar([&]<typename T>(T) {
    const Regions<T> regions(GetParam(), kRegions, 5000);
    const AnyWorld world = regions.world();
    Random random(7);
    std::uniform_real_distribution<float> center(0, 1);
    for (std::size_t count : {1u, 19u}) {
      std::vector<T> queries;
      for (std::size_t q = 0; q < count; ++q) {
        const auto query =
            regions.Query(0.01f, [&] { return T{center(random)}; });
        queries.insert(queries.end(), query.begin(), query.end());
      }
      const std::size_t words = MaskWords(world.size());
      std::vector<std::uint64_t> expected(count * words);
      std::vector<std::uint64_t> found(expected.size());
      for (Target target : TargetsUnderTest()) {
        for (std::size_t begin : {0u, 1u, 44000u}) {
          for (Schedule schedule :
               {Schedule::kFlat, Schedule::kAuto, Schedule::kStaged,
                Schedule::kStagedByAxis}) {
            auto& rows = schedule == Schedule::kFlat ? expected : found;
            std::fill(rows.begin(), rows.end(), std::uint64_t{0x5555});
            detail::SurvivorMasks(world.Asked({queries.data(), count}), rows,
                                  {.schedule = schedule,
                                   .target = target,
                                   .range = {begin, world.size()}},
                                  words);
            if (schedule == Schedule::kFlat) continue;
            EXPECT_EQ(found, expected)
                << target.name() << ": schedule " << static_cast<int>(schedule)
                << " from " << begin;
          }
        }
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(, StreamingTest, ::testing::ValuesIn(WholeFlatCases()),
                         FlatCaseName);

}  // namespace
}  // namespace halfspace::testing
