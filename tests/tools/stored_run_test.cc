// What --against finds: ratios that are worse than in a stored run, and stored
// runs that say nothing.
#include "bench/report/stored_run.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "bench/report/report.h"
#include "bench/report/report_field.h"

namespace halfspace::bench {
namespace {

KernelRow Row(const std::string& target, const Ratio& percent) {
  KernelRow row;
  row.shape = "aabb";
  row.schedule = "flat";
  row.working_set = "L2";
  row.target = target;
  row.ns_per_object = 1.0;
  row.percent_of_read = percent;
  return row;
}

Results RunOf(const std::vector<KernelRow>& rows,
              const std::vector<ThroughputRatio>& ratios = {}) {
  Results results;
  results.context.machine.cpu = "a CPU";
  results.options = "--quick";
  results.kernels = KernelsResult{rows, {}};
  results.throughput.emplace().ratios = ratios;
  return results;
}

// What is worse, and how many ratios there were.
struct Found {
  std::vector<Regression> worse;
  std::size_t compared = 0;
};

Found Compare(const Results& stored, const Results& now) {
  Found found;
  found.worse = StoredRun(ToJson(stored)).RegressionsIn(now, found.compared);
  return found;
}

constexpr Ratio kStored{95.0, 94.0, 96.0};

TEST(StoredRunTest, FindsTheRatiosThatAreWorse) {
  const Found found =
      Compare(RunOf({Row("AVX2", kStored), Row("SSE4", kStored)}),
              RunOf({Row("AVX2", {90.0, 89.0, 91.0}), Row("SSE4", kStored)}));
  EXPECT_EQ(found.compared, 2u);
  ASSERT_EQ(found.worse.size(), 1u);
  EXPECT_EQ(found.worse[0].section, "kernels");
  EXPECT_EQ(found.worse[0].ratio, "kernels, aabb, flat, L2, AVX2");
  EXPECT_EQ(found.worse[0].text,
            "kernels, aabb, flat, L2, AVX2: 90.00 [89.00, 91.00], was 95.00 "
            "[94.00, 96.00]");
}

TEST(StoredRunTest, ComparesWhatBothRunsHave) {
  const Found found = Compare(RunOf({Row("AVX2", kStored)}),
                              RunOf({Row("SSE4", {1.0, 1.0, 1.0})}));
  EXPECT_EQ(found.compared, 0u);
  EXPECT_TRUE(found.worse.empty());
}

TEST(StoredRunTest, KnowsWhatIsBetter) {
  const auto run = [](double value) {
    return RunOf({}, {{6, "a cost", value, 1.15, false,
                       Ratio{value, value - 0.01, value + 0.01}}});
  };
  EXPECT_EQ(Compare(run(1.0), run(1.2)).worse.size(), 1u);
  EXPECT_TRUE(Compare(run(1.2), run(1.0)).worse.empty());
}

TEST(StoredRunTest, LeavesOutWhatIsNoRatioOfRepetitions) {
  const auto run = [](double value) {
    return RunOf({Row("AVX2", kStored)},
                 {{7, "ns of a call", value, 20.0, false, std::nullopt}});
  };
  const Found found = Compare(run(10.0), run(100.0));
  EXPECT_EQ(found.compared, 1u);
  EXPECT_TRUE(found.worse.empty());
}

TEST(StoredRunTest, BuildsAreCompared) {
  const auto run = [](double low) {
    Results results = RunOf({});
    BuildRow row;
    row.shapes = "boxes";
    row.percent_of_copy = {low, low, low};
    results.build.emplace().rows.push_back(row);
    return results;
  };
  EXPECT_EQ(Compare(run(75.0), run(70.0)).worse.size(), 1u);
  EXPECT_TRUE(Compare(run(75.0), run(74.0)).worse.empty());
}

TEST(StoredRunTest, SortedWorldsAreCompared) {
  const auto run = [](double value) {
    Results results = RunOf({});
    results.sorted.emplace().ratios = {
        {1, "over trees", value, 7.0, true, Ratio{value, value, value}},
        {2, "memory", value, 0.6, false, std::nullopt}};
    return results;
  };
  const Found found = Compare(run(8.0), run(7.0));
  EXPECT_EQ(found.compared, 1u);
  ASSERT_EQ(found.worse.size(), 1u);
  EXPECT_EQ(found.worse[0].section, "sorted");
  EXPECT_EQ(found.worse[0].ratio, "sorted, over trees");
  EXPECT_TRUE(Compare(run(7.0), run(8.0)).worse.empty());
}

TEST(StoredRunTest, IsWorseBeyondTheSpreadAndTheTolerance) {
  const StoredRatio higher{{100.0, 95.0, 105.0}, true};
  EXPECT_FALSE(IsWorse(higher, {80.0, 70.0, 95.0 * (1.0 - kTolerance)}));
  EXPECT_TRUE(IsWorse(higher, {80.0, 70.0, 92.0}));
  const StoredRatio lower{{1.0, 0.95, 1.05}, false};
  EXPECT_FALSE(IsWorse(lower, {1.2, 1.05 * (1.0 + kTolerance), 1.4}));
  EXPECT_TRUE(IsWorse(lower, {1.2, 1.09, 1.4}));
}

TEST(StoredRunTest, SaysWhatIsNoReport) {
  const auto problem = [](const std::string& json) -> std::string {
    try {
      const StoredRun stored(json);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  for (const char* json :
       {"", "{", "0,0,0,1,1,1", R"({"schema": 3, "context": {"cpu": 3}})"}) {
    EXPECT_EQ(problem(json), "no JSON report of this program") << json;
  }
  EXPECT_EQ(problem("[]"), "the report is no object");
  EXPECT_EQ(problem("{}"), "the report has no schema");
  EXPECT_EQ(problem(std::string(100'000, '[')), "nested too deep");
  EXPECT_EQ(problem(std::string(kMostReportBytes + 1, ' ')),
            "larger than any report of this program");
  EXPECT_EQ(problem(R"({"schema": 1})"), "a report of schema 1, not 3");
  EXPECT_EQ(problem(ToJson(RunOf({}))), "a report without a ratio to compare");
  EXPECT_EQ(problem(ToJson(RunOf({Row("AVX2", kStored)}))), "");
}

TEST(StoredRunTest, IsOfOneMachineAndOneSetOfOptions) {
  const StoredRun stored(ToJson(RunOf({Row("AVX2", kStored)})));
  EXPECT_EQ(stored.WhyIncomparable("a CPU", "--quick"), "");
  EXPECT_EQ(stored.WhyIncomparable("another", "--quick"),
            "it is of a CPU, and this is another");
  EXPECT_EQ(stored.WhyIncomparable("a CPU", ""),
            "it was made with \"--quick\", and this run with \"\"");
}

}  // namespace
}  // namespace halfspace::bench
