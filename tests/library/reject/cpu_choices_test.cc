// All kernels of one query, streaming or not, with vectors of either width,
// against the flat one. Which of them calls use depends on the CPU
// (dispatch/targets/detect_targets.h), so all are tested on every machine.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "dispatch/targets/detect_targets.h"
#include "halfspace/reject_shapes.h"
#include "kernels/scan/kernel_table.h"
#include "tests/library/support/answers.h"
#include "tests/library/support/environment.h"
#include "tests/library/support/flat_cases.h"
#include "tests/library/support/owners.h"
#include "tests/library/support/quantized_cases.h"

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
    case detail::PlaneLayout::kSphere:
      break;
  }
  return {detail::kAll,    detail::kAllStreaming, detail::kByAxis,
          detail::kByHalf, detail::kBySimplex,    detail::kAdaptive};
}

class CpuChoicesTest : public ::testing::TestWithParam<FlatCase> {};

TEST_P(CpuChoicesTest, TestLikeTheFlatKernel) {
  const FlatCase& kind = GetParam();
  const bool is_simplex = kind.layout.kind == detail::PlaneLayout::kSimplex;
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
          scan.is_streaming = scan.is_in_memory = scan.is_wide = false;
          const auto expected = WordsOf(scan, scan.type->flat);
          for (bool is_wide : {false, true}) {
            scan.is_wide = is_wide;
            for (ScanKernel kernel : KernelsOf(kind.layout.kind)) {
              for (bool is_streaming : {false, true}) {
                scan.is_streaming = scan.is_in_memory = is_streaming;
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

INSTANTIATE_TEST_SUITE_P(, CpuChoicesTest, ::testing::ValuesIn(AllFlatCases()),
                         ::testing::PrintToStringParamName());

// Whole calls, also on quantized bounds, by half-spaces and of kernels.h. 5
// queries: four share their loads, and one does not.
TEST(WideVectorsTest, CallsHaveTheSameAnswers) {
  const std::vector<Target> targets = TargetsUnderTest();
  // A call that has to find its target sets the choice.
  for (Target target : targets) dispatch::IndexOf(target, "cpu_choices_test");
  Random random(1);
  for (const QuantizedRow& row : QuantizedRows()) {
    if (row.layout.dims != 3) continue;
    SCOPED_TRACE(row.name);
    const auto values = MakeQuantizedValues(
        row.layout, QuantizedInputKind::kUniform, 5000, random);
    const auto queries = MakeQuantizedQueries(row.layout, values, 5, random);
    const AnyQuantized all = row.Make(values);
    const float half_spaces[] = {1, 2, 3, 2, -1, 0, 0, 10};
    std::vector<std::uint64_t> mask(MaskWords(5000));
    std::vector<std::uint64_t> expected;
    for (bool is_wide : {false, true}) {
      dispatch::wide_vectors_pay = is_wide;
      for (std::size_t count : {1, 5}) {
        const AnyQueries some(queries.data(), count);
        const Answers exact = Answers::OfReference(all.floats(), some);
        EXPECT_TRUE(AnswersEverywhere(exact, all.floats(), some, targets));
        EXPECT_TRUE(QuantizedAnswersEverywhere(all.quantized(), all.refined(),
                                               exact, some, targets));
      }
      for (Target target : targets) {
        detail::Ask(detail::ShapeScan{all.floats().Asked({}), half_spaces, 2},
                    "SurvivorMask", [&](detail::Scan&& scan) {
                      detail::SurvivorMask(std::move(scan), mask,
                                           {.target = target});
                    });
        if (expected.empty()) expected = mask;
        EXPECT_EQ(mask, expected) << target.name();
      }
    }
  }
  dispatch::wide_vectors_pay = dispatch::DetectWideVectorsPay();
}

}  // namespace
}  // namespace halfspace::testing
