// The streaming kernels against the flat ones, and the schedules against each
// other. Calls use them only where
// StreamingPays(), so they are tested here on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/halfspace.h"
#include "kernels/scan/kernel_table.h"
#include "tests/library/support/cases.h"
#include "tests/library/support/environment.h"

namespace halfspace::testing {
namespace {

using detail::ScanKernel;

template <typename Bound>
Bound RandomBound(std::mt19937& random, float half_size) {
  std::uniform_real_distribution<float> place(0, 1);
  using Scalar = typename Bound::Scalar;
  Bound bound{};
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    const float center = place(random);
    bound.min[k] = Scalar{center - half_size};
    if constexpr (detail::HasMax<Bound>)
      bound.max[k] = Scalar{center + half_size};
  }
  return bound;
}

std::vector<std::uint64_t> WordsOf(const detail::Scan& scan, ScanKernel kernel,
                                   std::size_t size) {
  // One word more, which no kernel may touch.
  std::vector<std::uint64_t> words(MaskWords(size) + 1, 0x5555);
  const detail::Chunk chunk{.first_query = 0,
                            .query_count = 1,
                            .queries = scan.queries,
                            .begin = scan.begin,
                            .end = scan.begin + size,
                            .rows = words.data(),
                            .stride = 0};
  scan.kernels->run[kernel](scan, chunk);
  return words;
}

// Objects from `begin` on, so that planes are aligned or not.
template <typename View>
void Compare(ScanKernel flat, ScanKernel streaming, std::size_t begin,
             std::size_t size, float half_size) {
  using Bound = typename View::Bound;
  std::mt19937 random(static_cast<unsigned>(size));
  World<View> world;
  for (std::size_t i = 0; i < begin + size; ++i) {
    world.Push(RandomBound<Bound>(random, half_size));
  }
  typename View::Query query{};
  for (std::size_t k = 0; k < Bound::kAxes; ++k) {
    query.max[k] = 0.5f + half_size;
    if constexpr (detail::HasMin<typename View::Query>) {
      query.min[k] = 0.5f - half_size;
    }
  }
  const View view = world.view();
  detail::Scan scan = detail::ScanOf(view, &query, 1);
  scan.begin = begin;
  scan.end = begin + size;
  for (Target target : TargetsUnderTest()) {
    scan.kernels =
        *scan.type->all_kernels + dispatch::IndexOf(target, "streaming_test");
    scan.is_streaming = false;
    const auto expected = WordsOf(scan, flat, size);
    scan.is_streaming = true;
    EXPECT_EQ(WordsOf(scan, streaming, size), expected)
        << target.name() << ": " << size << " objects from " << begin << ", "
        << half_size;
  }
}

template <typename View>
void CompareSizes(ScanKernel flat, ScanKernel streaming) {
  // Whole pages, parts of one, and tiles of 4096 objects; with and without
  // tail.
  for (std::size_t size : {1u, 64u, 1024u, 1088u, 4096u, 9000u}) {
    for (std::size_t begin : {0u, 1u}) {
      // Of the words of a tile few survive, and almost all.
      for (float half_size : {0.02f, 0.2f}) {
        Compare<View>(flat, streaming, begin, size, half_size);
      }
    }
  }
}

template <typename... Cases>
void CompareAll(ScanKernel flat, ScanKernel streaming,
                ::testing::Types<Cases...>) {
  (CompareSizes<typename Cases::View>(flat, streaming), ...);
}

TEST(Streaming, TestsMinimaLikeTheFlatKernel) {
  using Cases = ::testing::Types<Whole<SimplexView2>, Whole<SimplexView3>>;
  CompareAll(ScanKernel::kMinima, ScanKernel::kMinimaStreaming,
             Tested<Cases>());
}

TEST(Streaming, TestsAllPlanesLikeTheFlatKernel) {
  using Cases = ::testing::Types<Whole<AabbView2>, Whole<AabbView3>,
                                 Whole<AabbView<3, double>>>;
  CompareAll(ScanKernel::kAll, ScanKernel::kAllStreaming, Tested<Cases>());
}

TEST(Streaming, TestsBySimplexLikeTheFlatKernel) {
  using Cases = ::testing::Types<Whole<AaboView2>, Whole<AaboView3>>;
  CompareAll(ScanKernel::kAll, ScanKernel::kBySimplex, Tested<Cases>());
}

// A world of regions, each with its density of survivors: kAdaptive goes up and
// down through its steps, and each of them, and each change, must keep the
// bits.
template <typename View>
void CompareRegions(std::size_t queries) {
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  // Half sizes of objects in a unit world, one for each region.
  constexpr float kRegions[] = {0.001f, 0.2f,   0.015f, 0.6f, 0.001f,
                                0.05f,  0.001f, 0.015f, 0.2f};
  constexpr std::size_t kRegionObjects = 5000;
  std::mt19937 random(7);
  World<View> world;
  for (float half_size : kRegions) {
    for (std::size_t i = 0; i < kRegionObjects; ++i) {
      world.Push(RandomBound<Bound>(random, half_size));
    }
  }
  std::vector<Query> all(queries);
  for (Query& query : all) query = Query(RandomBound<Bound>(random, 0.01f));
  std::vector<std::uint64_t> expected(queries * MaskWords(world.size()));
  std::vector<std::uint64_t> found(expected.size());
  for (Target target : TargetsUnderTest()) {
    for (std::size_t begin : {0u, 1u, 44000u}) {
      Options options{.target = target, .range = {begin, world.size()}};
      for (Schedule schedule : {Schedule::kFlat, Schedule::kAuto,
                                Schedule::kStaged, Schedule::kStagedByAxis}) {
        options.schedule = schedule;
        auto& rows = schedule == Schedule::kFlat ? expected : found;
        std::fill(rows.begin(), rows.end(), std::uint64_t{0x5555});
        SurvivorMasks(world, all, rows, options, MaskWords(world.size()));
        if (schedule == Schedule::kFlat) continue;
        EXPECT_EQ(found, expected)
            << target.name() << ": schedule " << static_cast<int>(schedule)
            << " from " << begin;
      }
    }
  }
}

template <typename... Cases>
void CompareAllRegions(::testing::Types<Cases...>) {
  (CompareRegions<typename Cases::View>(1), ...);
  (CompareRegions<typename Cases::View>(19), ...);
}

TEST(Schedules, AgreeWhereTheDensityChanges) {
  using Cases =
      ::testing::Types<Whole<AabbView2>, Whole<AabbView3>, Whole<AaboView3>,
                       Whole<AabbView<3, double>>, Whole<AabbView<4>>>;
  CompareAllRegions(Tested<Cases>());
}

}  // namespace
}  // namespace halfspace::testing
