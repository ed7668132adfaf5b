// The streaming kernels against the flat ones. Calls use these kernels only
// where StreamingPays(), so they are tested here on every machine.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dispatch/targets/chosen_target.h"
#include "halfspace/reject_many.h"
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
          scan.kernels = *scan.type->all_kernels +
                         dispatch::IndexOf(target, "streaming_test");
          scan.is_streaming = false;
          const auto expected = WordsOf(scan, flat);
          scan.is_streaming = true;
          EXPECT_EQ(WordsOf(scan, streaming), expected)
              << target.name() << ": " << size << " objects from " << scan.begin
              << ", " << NameOf(input_kind);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, StreamingTest, ::testing::ValuesIn(WholeFlatCases()),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace halfspace::testing
