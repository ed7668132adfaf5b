// What the section sorted prints, what its ratios need, and on which boxes it
// measures.
#include <gtest/gtest.h>

#include <cstddef>
#include <sstream>
#include <string>
#include <vector>

#include "bench/report/report.h"
#include "bench/report/thresholds.h"
#include "bench/worlds/box_set.h"

namespace halfspace::bench {
namespace {

SortedResult SomeResult() {
  SortedResult result;
  SortedWorkload workload;
  workload.name = "a";
  workload.objects = 100'000;
  workload.survivors = 5.5;
  workload.blocks = 8.0;
  workload.rows.push_back(
      {"tight, one query a call", "AVX2", 200.0, 250.0, 5.0, 6.0});
  workload.rows.push_back({"grid", "", 1000.0, 1500.0, {}, {}});
  result.workloads.push_back(workload);
  result.jobs.push_back({"fast", 100'000, 6.25});
  result.scan_is_faster_below = 45.2;
  result.ratios.push_back({1, "over trees", 5.0, 4.2, true});
  result.ratios.push_back({2, "memory", 0.7, 0.6, false});
  result.remarks.push_back("a remark");
  result.not_reached.push_back("threshold 1: no file");
  return result;
}

std::string TextOf(const SortedResult& result) {
  std::ostringstream text;
  WriteText(text, result);
  return text.str();
}

void ExpectPart(const std::string& text, const char* part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(SortedReportTest, TextHasATableForEachWorkload) {
  const std::string text = TextOf(SomeResult());
  ExpectPart(
      text,
      "a: 100 000 boxes, of which a query finds 5.5 in 8.0 blocks of 64, "
      "each in 25.0 ns");
  ExpectPart(
      text,
      "tight, one query a call AVX2    0.200   5.00         0.250   6.00");
  ExpectPart(
      text,
      "grid                    -       1.000      -         1.500      -");
  ExpectPart(text, "fast            100 000  6.2");
  ExpectPart(text, "Below 45 boxes a flat scan is faster");
  ExpectPart(text, "a remark.");
  ExpectPart(text, "over trees met      5.00  >= 4.20");
  ExpectPart(text, "memory     missed   0.70  <= 0.60");
  ExpectPart(text, "1 of 2 aims are met. One that is missed is no failure");
  ExpectPart(text, "not reached: threshold 1: no file");
}

TEST(SortedReportTest, TextSaysWhereAScanNeverWins) {
  SortedResult result = SomeResult();
  result.scan_is_faster_below = 0.0;
  ExpectPart(TextOf(result), "A flat scan is at no size faster");
}

TEST(SortedThresholdTest, IsHalfWhereEvictedAndSixTenthsWithoutAvx512) {
  const Threshold threshold = thresholds::TimesFastest(7.0);
  EXPECT_DOUBLE_EQ(threshold.avx512, 7.0);
  EXPECT_DOUBLE_EQ(threshold.avx2, 4.2);
  const Threshold evicted = thresholds::WhereEvicted(threshold);
  EXPECT_EQ(evicted.threshold, 1);
  EXPECT_DOUBLE_EQ(evicted.avx512, 3.5);
  EXPECT_DOUBLE_EQ(evicted.avx2, 2.1);
}

template <int kDims>
void ExpectBoxes(const BoxSet<kDims>& set, std::size_t count) {
  EXPECT_EQ(set.boxes.size(), count);
  EXPECT_EQ(set.queries.size(), kTimedQueries);
  for (const auto* boxes : {&set.boxes, &set.queries}) {
    for (const auto& box : *boxes) {
      for (std::size_t k = 0; k < kDims; ++k) {
        ASSERT_LT(box.min[k], box.max[k]);
        ASSERT_LT(box.max[k] - box.min[k], 4.0f);
        ASSERT_GT(box.min[k], -70.0f);
        ASSERT_LT(box.max[k], 70.0f);
      }
    }
  }
}

TEST(BoxSetTest, HasBoxesAndQueriesOfOneKind) {
  ExpectBoxes(MakeUniformBoxes<2>("2D", 100, 0.37f, 1), 100);
  const BoxSet<3> uniform = MakeUniformBoxes<3>("a", 100, 1.9f, 1);
  ExpectBoxes(uniform, 100);
  EXPECT_NEAR(uniform.boxes[0].max[0] - uniform.boxes[0].min[0], 1.9f, 1e-4f);
  ExpectBoxes(MakeClusters("clusters", 100, 1), 100);
}

TEST(BoxSetTest, DependsOnTheSeedAlone) {
  EXPECT_EQ(MakeClusters("", 10, 1).boxes, MakeClusters("", 10, 1).boxes);
  EXPECT_NE(MakeClusters("", 10, 1).boxes, MakeClusters("", 10, 2).boxes);
}

// Two boxes of a cluster are near each other more often than two of all.
TEST(BoxSetTest, ClustersAreDense) {
  const auto near = [](const std::vector<Aabb3>& boxes) {
    std::size_t count = 0;
    for (std::size_t i = 1; i < boxes.size(); ++i) {
      bool is_near = true;
      for (std::size_t k = 0; k < 3; ++k) {
        is_near &= boxes[i].min[k] - boxes[0].min[k] < 6.0f &&
                   boxes[0].min[k] - boxes[i].min[k] < 6.0f;
      }
      count += is_near ? 1 : 0;
    }
    return count;
  };
  EXPECT_GT(near(MakeClusters("", 10'000, 1).boxes),
            4 * near(MakeUniformBoxes<3>("", 10'000, 1, 1).boxes));
}

TEST(BoxSetTest, TakesAFilesBoxesAndRepeatsItsQueries) {
  const Aabb3 first{{0, 0, 0}, {1, 1, 1}};
  const Aabb3 second{{2, 2, 2}, {3, 3, 3}};
  const BoxSet<3> set =
      BoxesOf("file", WorkloadOfBoxes("", {first, second}, 0));
  EXPECT_EQ(set.boxes, (std::vector<Aabb3>{first, second}));
  ASSERT_EQ(set.queries.size(), kTimedQueries);
  EXPECT_NE(set.queries[0], set.queries[1]);
  EXPECT_EQ(set.queries[0], set.queries[2]);
}

}  // namespace
}  // namespace halfspace::bench
