// All kernels of one query, streaming or not, with vectors of either width,
// against the flat one. Which of them calls use depends on the CPU
// (dispatch/targets/detect_targets.h), so all are tested on every machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "halfspace/fit.h"
#include "halfspace/kernels.h"
#include "halfspace/quantized.h"
#include "halfspace/reject_many.h"
#include "halfspace/reject_shapes.h"
#include "kernels/scan/kernel_table.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

using detail::ScanKernel;

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

// The kernels that test all planes of a bound of this kind.
std::vector<ScanKernel> KernelsOf(detail::PlaneLayout::Kind kind) {
  switch (kind) {
    case detail::PlaneLayout::kSimplex:
      return {detail::kMinima, detail::kMinimaStreaming};
    case detail::PlaneLayout::kAabb:
      return {detail::kAll, detail::kAllStreaming, detail::kByAxis,
              detail::kByHalf, detail::kAdaptive};
    case detail::PlaneLayout::kAabo:
      break;
  }
  return {detail::kAll,    detail::kAllStreaming, detail::kByAxis,
          detail::kByHalf, detail::kBySimplex,    detail::kAdaptive};
}

class CpuChoicesTest : public ::testing::TestWithParam<FlatCase> {};

TEST_P(CpuChoicesTest, TestLikeTheFlatKernel) {
  const FlatCase& kind = GetParam();
  const bool is_simplex = kind.seen.kind == detail::PlaneLayout::kSimplex;
  Random random(1);
  // Whole pages, parts of one, and tiles of 4096 objects; with and without
  // tail.
  for (std::size_t size : {1u, 64u, 1024u, 1088u, 4096u, 9000u}) {
    // Of the words of a tile few survive, and almost all.
    for (InputKind input_kind : {InputKind::kSparse, InputKind::kDense}) {
      const FlatInput input(kind, input_kind, size + 1, random);
      const AnyWorld world = input.WorldAt(0, size + 1, 1);
      detail::Scan scan = world.Asked(input.query());
      // Planes are aligned or not.
      for (scan.begin = 0; scan.begin < 2; ++scan.begin) {
        scan.end = scan.begin + size;
        for (Target target : TargetsUnderTest()) {
          SCOPED_TRACE(std::string(target.name()) + ": " +
                       std::to_string(size) + " objects from " +
                       std::to_string(scan.begin) + ", " +
                       std::string(NameOf(input_kind)));
          scan.kernels = *scan.type->all_kernels +
                         dispatch::IndexOf(target, "cpu_choices_test");
          scan.is_streaming = scan.is_wide = false;
          const auto expected = WordsOf(scan, scan.type->flat);
          for (bool is_wide : {false, true}) {
            scan.is_wide = is_wide;
            for (ScanKernel kernel : KernelsOf(kind.seen.kind)) {
              for (bool is_streaming : {false, true}) {
                scan.is_streaming = is_streaming;
                EXPECT_EQ(WordsOf(scan, kernel), expected)
                    << "kernel " << int{kernel} << ", wide: " << is_wide;
              }
            }
            auto words = std::vector<std::uint64_t>(expected.size(), 0x5555);
            (is_simplex ? scan.kernels->mask_of_minima
                        : scan.kernels->mask_of_all)[is_wide](
                scan.planes, scan.begin, size, scan.queries, words.data());
            EXPECT_EQ(words, expected) << "mask, wide: " << is_wide;
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, CpuChoicesTest,
                         ::testing::ValuesIn(WholeFlatCases()),
                         ::testing::PrintToStringParamName());

// Whole calls, also on quantized bounds, by half-spaces and of kernels.h. 5
// queries: four share their loads, and one does not.
TEST(WideVectorsTest, CallsHaveTheSameAnswers) {
  Random random(1);
  const auto between = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  const auto box_of = [&](float size) {
    Aabb3 box;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = between(0, 1);
      box.max[k] = box.min[k] + size;
    }
    return BoundAabb(box);
  };
  AaboWorld3 world;
  for (int i = 0; i < 5000; ++i) world.Push(box_of(0.1f));
  const QuantizedWorld<AaboView3> bytes(world);
  const QuantizedWorld<AaboView3, std::uint16_t> words(world);
  std::vector<Aabo3> queries;
  for (int q = 0; q < 5; ++q) queries.push_back(box_of(0.3f));
  const std::vector<HalfSpace3> half_spaces = {{{1, 2, 3}, 2.0f},
                                               {{-1, 0, 0}, 0.1f}};
  const std::size_t row = MaskWords(world.size());
  for (Target target : TargetsUnderTest()) {
    const Options options{.target = target};
    std::vector<std::uint64_t> answers[2];
    for (bool is_wide : {false, true}) {
      auto& masks = answers[is_wide];
      masks.resize(row * (3 * queries.size() + 2));
      const auto part = [&](std::size_t first, std::size_t rows) {
        return Span<std::uint64_t>(masks.data() + first * row, rows * row);
      };
      dispatch::IndexOf(target, "cpu_choices_test");
      dispatch::wide_vectors_pay = is_wide;
      SurvivorMasks(world, queries, part(0, 5), options);
      SurvivorMasks(bytes, queries, part(5, 5), options);
      SurvivorMasks(words, queries, part(10, 5), options);
      SurvivorMask(world, half_spaces, part(15, 1), options);
      const float* planes[8];
      float query[8];
      for (std::size_t k = 0; k < 4; ++k) {
        planes[k] = world.view().min[k];
        planes[4 + k] = world.view().max[k];
        query[k] = queries[0].min[k];
        query[4 + k] = queries[0].max[k];
      }
      KernelsOf<float>(target).octahedra3.one(planes, world.size(), query,
                                              part(16, 1).data());
    }
    EXPECT_EQ(answers[0], answers[1]) << target.name();
    EXPECT_TRUE(std::equal(answers[0].begin(),
                           answers[0].begin() + std::ptrdiff_t(row),
                           answers[0].end() - std::ptrdiff_t(row)));
  }
  dispatch::wide_vectors_pay = dispatch::DetectWideVectorsPay();
}

}  // namespace
}  // namespace halfspace::testing
