// The parts of the JSON report that programs rely on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>
#endif

#include "bench/app/run.h"
#include "bench/base/write_whole.h"
#include "bench/measure/machine.h"
#include "bench/report/report.h"
#include "halfspace/targets.h"
#include "tests/library/support/sanitized.h"

namespace halfspace::bench {
namespace {

using Json = nlohmann::json;

// A real run of everything, as small as it gets.
const Json& Report() {
  static const Json report = [] {
    BenchOptions options;
    options.is_quick = true;
    options.details = {"machine", "check",   "table1",   "crossover",
                       "build",   "sorted",  "quality",  "volumes",
                       "dual",    "axes",    "segments", "model",
                       "sweep",   "threads", "noise",    "answers"};
    options.objects = 4096;
    options.queries = 4;
    options.repetitions = 1;
    options.target = std::string(ChosenTarget().name());
    Progress progress;
    return Json::parse(ToJson(Run(options, std::nullopt, progress, nullptr)));
  }();
  return report;
}

#if defined(__linux__) && !defined(HALFSPACE_SANITIZED)
TEST(MemoryTest, RunWithoutEnoughPrintsWholeSectionsAndNamesTheNext) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit old;
  ASSERT_EQ(getrlimit(RLIMIT_AS, &old), 0);
  rlimit tight = old;
  tight.rlim_cur = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) +
                   (std::size_t{24} << 20);
  BenchOptions options;
  options.is_quick = true;
  options.details = {"machine", "volumes"};
  Progress progress;
  std::ostringstream text;
  std::string error;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &tight), 0);
  rlimit taken;
  getrlimit(RLIMIT_AS, &taken);
  if (taken.rlim_cur != tight.rlim_cur) GTEST_SKIP() << "qemu has no limit";
  EXPECT_LE(FreeMemory(), std::size_t{24} << 20);
  try {
    bench::Run(options, std::nullopt, progress, &text);
  } catch (const std::exception& caught) {
    error = caught.what();
  }
  setrlimit(RLIMIT_AS, &old);
  EXPECT_EQ(error.find("not enough memory for the section volumes; "), 0u)
      << error;
  EXPECT_NE(text.str().find("\n\nmachine: "), std::string::npos) << text.str();
  EXPECT_EQ(text.str().find("volumes"), std::string::npos) << text.str();
}
#endif

TEST(MemoryTest, WriteWholeWritesAllOrNothing) {
  std::ostringstream out;
  EXPECT_THROW(WriteWhole(out,
                          [](std::ostream& text) {
                            text << "half a line";
                            throw std::bad_alloc();
                          }),
               std::bad_alloc);
  EXPECT_EQ(out.str(), "");
  WriteWhole(out, [](std::ostream& text) { text << "a line\n"; });
  EXPECT_EQ(out.str(), "a line\n");
}

TEST(ReportJsonTest, HasSchemaContextBenchmarksAndSections) {
  EXPECT_EQ(Report().at("schema"), kReportSchema);
  EXPECT_EQ(Report().at("context").at("options"),
            "--quick --objects 4096 --queries 4");
  EXPECT_TRUE(Report().at("context").at("num_cpus").is_number());
  EXPECT_FALSE(Report().at("benchmarks").empty());
  for (const Json& benchmark : Report().at("benchmarks")) {
    EXPECT_EQ(benchmark.at("time_unit"), "ns");
    EXPECT_GT(benchmark.at("cpu_time"), 0.0) << benchmark;
  }
  EXPECT_FALSE(Report().at("sections").contains("kernels"));
}

TEST(ReportJsonTest, Table1HasTheFixedForm) {
  const Json& table = Report().at("sections").at("table1");
  EXPECT_EQ(table.at("widths"), Json({1, 8, 16, 64, 256, 1024, 4096}));
  for (const char* shape : {"aabb", "simplex", "aabo"}) {
    EXPECT_EQ(table.at("half_spaces").at(shape).size(), 7u) << shape;
    EXPECT_TRUE(table.at("accepts").at(shape).is_number_unsigned()) << shape;
  }
}

TEST(ReportJsonTest, QualityHasTheFixedForm) {
  const Json& quality = Report().at("sections").at("quality");
  EXPECT_EQ(quality.at("objects"), 4096);
  EXPECT_EQ(quality.at("queries"), 4);
  const Json& survivors = quality.at("survivors");
  EXPECT_GE(survivors.at("simplex"), survivors.at("aabb"));
  EXPECT_LE(survivors.at("aabo"), survivors.at("aabb"));
}

void ExpectKeys(const Json& rows, const std::vector<const char*>& keys) {
  ASSERT_FALSE(rows.empty());
  for (const Json& row : rows) {
    for (const char* key : keys) EXPECT_TRUE(row.contains(key)) << key;
  }
}

TEST(ReportJsonTest, VolumesHaveTheFixedForm) {
  const Json& volumes = Report().at("sections").at("volumes");
  ExpectKeys(
      volumes.at("rows"),
      {"volume", "schedule", "target", "working_set", "objects",
       "bytes_per_object", "ns_per_object", "over_simplex", "looseness"});
  ASSERT_EQ(volumes.at("dimensions").size(), 3u);
  ExpectKeys(volumes.at("dimensions"),
             {"dimensions", "target", "objects", "scale", "simplex_ns",
              "aabb_flat_ns", "aabb_staged_ns", "aabo_flat_ns",
              "aabo_staged_ns", "simplex_over_flat_aabb",
              "simplex_over_fastest_aabb", "queries", "survivors"});
  for (const Json& row : volumes.at("dimensions")) {
    EXPECT_LE(row.at("survivors").at("aabo"), row.at("survivors").at("aabb"));
    EXPECT_EQ(row.at("simplex_over_flat_aabb").at("quartiles").size(), 2u);
  }
}

TEST(ReportJsonTest, DualRowsHaveTheFixedForm) {
  const Json& rows = Report().at("sections").at("dual").at("rows");
  ExpectKeys(rows,
             {"content", "working_set", "target", "lanes", "objects",
              "second_of_1", "second_of_lanes", "second_of_64", "simplex_ns",
              "refined_ns", "flat_ns", "staged_ns", "staged_over_flat",
              "refined_over_staged", "staged_over_simplex"});
  for (const Json& row : rows) {
    EXPECT_LE(row.at("second_of_1"), row.at("second_of_lanes"));
    EXPECT_LE(row.at("second_of_lanes"), row.at("second_of_64"));
  }
}

TEST(ReportJsonTest, AxesHaveTheFixedForm) {
  const Json& axes = Report().at("sections").at("axes");
  ASSERT_EQ(axes.at("construction").size(), 3u);
  ExpectKeys(axes.at("construction"),
             {"axes", "target", "clouds", "flops_per_point", "rounded_planes",
              "ns_per_cloud", "over_standard", "pad_over_extent"});
  ASSERT_EQ(axes.at("alignment").size(), 6u);
  ExpectKeys(axes.at("alignment"),
             {"world", "objects", "queries", "axes", "survivors"});
}

TEST(ReportJsonTest, CrossoverRowsHaveTheFixedForm) {
  const Json& crossover = Report().at("sections").at("crossover");
  ASSERT_FALSE(crossover.at("rows").empty());
  for (const Json& row : crossover.at("rows")) {
    for (const char* key : {"target", "lanes", "working_set", "schedule", "w",
                            "aabb_ns", "simplex_ns", "aabo_ns"}) {
      EXPECT_TRUE(row.contains(key)) << key << " in " << row;
    }
    EXPECT_TRUE(row.at("aabo_ns").is_number()) << row;
    EXPECT_EQ(row.at("w").is_number(), row.at("schedule") == "every-plane");
  }
  ASSERT_FALSE(crossover.at("targets").empty());
  for (const Json& target : crossover.at("targets")) {
    EXPECT_TRUE(target.at("w_star").is_number() ||
                target.at("w_star").is_null());
  }
}

TEST(ReportJsonTest, BuildRowsHaveTheFixedForm) {
  const Json& build = Report().at("sections").at("build");
  ASSERT_FALSE(build.at("rows").empty());
  bool is_memory_reached = false;
  for (const Json& row : build.at("rows")) {
    for (const char* key : {"shapes", "planes", "rounding", "target",
                            "working_set", "objects", "item", "copy"}) {
      EXPECT_TRUE(row.contains(key)) << key << " in " << row;
    }
    for (const char* key : {"ns_per_item", "gigabytes_per_second",
                            "percent_of_copy", "copy_gigabytes_per_second"}) {
      EXPECT_GT(row.at(key), 0.0) << key << " in " << row;
    }
    EXPECT_LE(row.at("quartiles").at(0), row.at("percent_of_copy"));
    EXPECT_GE(row.at("quartiles").at(1), row.at("percent_of_copy"));
    EXPECT_EQ(row.at("item") == "point", row.at("shapes") == "point-sets");
    is_memory_reached |= row.at("working_set") == "memory";
  }
  EXPECT_EQ(build.at("thresholds").size(), is_memory_reached ? 1u : 0u);
  for (const Json& threshold : build.at("thresholds")) {
    EXPECT_EQ(threshold.at("target"), std::string(ChosenTarget().name()));
    EXPECT_EQ(threshold.at("at_least"), 70.0);
    EXPECT_EQ(threshold.at("met"), threshold.at("percent_of_copy") >= 70.0);
  }
  EXPECT_GE(build.at("singles").size(), 20u);
  for (const Json& row : build.at("singles")) {
    EXPECT_GT(row.at("ns_per_call"), 0.0) << row.at("call");
  }
  EXPECT_TRUE(build.at("not_reached").is_array());
}

TEST(ReportJsonTest, SortedHasTheFixedForm) {
  const Json& sorted = Report().at("sections").at("sorted");
  std::vector<std::string> names;
  for (const Json& workload : sorted.at("workloads")) {
    names.push_back(workload.at("name"));
    EXPECT_LE(workload.at("objects"), 4096);
    EXPECT_GT(workload.at("survivors_per_query"), 0.0);
    // Of box queries, in all ways; the others are one kind of search each.
    const bool is_contest = workload.at("blocks_per_query") > 0.0;
    std::size_t ours = 0;
    bool has_grid = false;
    for (const Json& row : workload.at("rows")) {
      EXPECT_GT(row.at("ns_per_query"), 0.0) << row;
      if (is_contest) {
        EXPECT_GT(row.at("ns_per_query_in_turns"), 0.0) << row;
        EXPECT_EQ(row.at("over_fastest").is_null(),
                  row.at("over_fastest_in_turns").is_null());
      }
      ours += row.at("target").is_string() ? 1 : 0;
      has_grid |= row.at("name") == "grid";
    }
    EXPECT_GE(ours, is_contest ? 5u : 1u) << workload;
    EXPECT_EQ(has_grid, is_contest) << workload;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"a", "clusters", "2D",
                                             "counts of a tenth", "nearest 8",
                                             "along a segment"}));
  ASSERT_GE(sorted.at("jobs").size(), 2u);
  for (const Json& job : sorted.at("jobs")) {
    EXPECT_EQ(job.at("objects"), 4096);
    EXPECT_GT(job.at("ms"), 0.0) << job;
  }
  EXPECT_TRUE(sorted.at("scan_is_faster_below").is_number());
  // Of a file, as there is none.
  EXPECT_FALSE(sorted.at("not_reached").empty());
  EXPECT_TRUE(sorted.at("remarks").is_array());
  for (const Json& ratio : sorted.at("ratios")) {
    EXPECT_TRUE(ratio.at("threshold") >= 1 && ratio.at("threshold") <= 5);
    EXPECT_GT(ratio.at("value"), 0.0) << ratio;
    EXPECT_EQ(ratio.at("met"), ratio.at("better") == "higher"
                                   ? ratio.at("value") >= ratio.at("needed")
                                   : ratio.at("value") <= ratio.at("needed"))
        << ratio;
  }
  EXPECT_FALSE(sorted.at("ratios").empty());
}

TEST(ReportJsonTest, SegmentRowsHaveTheFixedForm) {
  const Json& segments = Report().at("sections").at("segments");
  EXPECT_EQ(segments.at("objects"), 4096);
  EXPECT_EQ(segments.at("segments"), 8);
  EXPECT_EQ(segments.at("seed"), 1);
  EXPECT_EQ(segments.at("workload"), "scene");
  // Directions, lengths, pieces.
  ASSERT_EQ(segments.at("rows").size(), 3u * 3u * 6u);
  for (const Json& row : segments.at("rows")) {
    const double aabo = row.at("kept").at("aabo");
    EXPECT_LE(aabo, row.at("kept").at("aabb")) << row;
    EXPECT_LE(aabo, row.at("kept").at("simplex")) << row;
    EXPECT_GE(aabo, row.at("floor")) << row;
    const std::size_t tests = row.at("tests");
    EXPECT_EQ(tests, 4096 * row.at("pieces").get<std::size_t>());
    EXPECT_EQ(row.at("bytes").at("simplex"), tests * 16);
    EXPECT_EQ(row.at("bytes").at("aabb"), tests * 24);
    EXPECT_EQ(row.at("bytes").at("aabo"), tests * 32);
  }
}

TEST(ReportJsonTest, ModelHasTheFixedForm) {
  const Json& model = Report().at("sections").at("model");
  ASSERT_EQ(model.at("shapes").size(), 3u);
  for (const Json& shape : model.at("shapes")) {
    for (const Json& row : shape.at("rows")) {
      // p is an average over half-spaces: the expectation need not be right.
      EXPECT_GE(row.at("counted_half_spaces"), 1.0) << row;
      EXPECT_LE(row.at("counted_half_spaces"), shape.at("planes")) << row;
      EXPECT_GT(row.at("measured_ns"), 0.0) << row;
    }
  }
  EXPECT_EQ(model.at("exact_tests").size(), 3u);
  EXPECT_EQ(model.at("break_even").size(), 2u);
}

TEST(ReportJsonTest, SweepCellsNameTheFastestOfAllWays) {
  const Json& sweep = Report().at("sections").at("sweep");
  std::vector<Json> cells = sweep.at("cells");
  EXPECT_EQ(cells.size(), 6u);
  cells.push_back(sweep.at("own"));
  for (const Json& cell : cells) {
    // Schedules of simplex, box and octahedron in three precisions, and sorted
    // worlds.
    ASSERT_EQ(cell.at("ways").size(), 3u * (1 + 2 + 3) + 3);
    for (const Json& way : cell.at("ways")) {
      EXPECT_GE(way.at("ns_with_exact"), cell.at("ns")) << way;
      EXPECT_NEAR(
          way.at("ns_with_exact").get<double>(),
          way.at("ns").get<double>() + sweep.at("exact_ns").get<double>() *
                                           way.at("survivors").get<double>(),
          1e-6)
          << way;
    }
  }
}

TEST(ReportJsonTest, AnswersAreToAllQuestions) {
  std::vector<std::string> questions;
  for (const Json& answer :
       Report().at("sections").at("answers").at("answers")) {
    questions.push_back(answer.at("question"));
    EXPECT_GE(answer.at("figure"), answer.at("quartiles").at(0));
    EXPECT_LE(answer.at("figure"), answer.at("quartiles").at(1));
  }
  questions.resize(4);  // threads are of machines with more than one CPU
  EXPECT_EQ(questions, (std::vector<std::string>{"shape", "schedule",
                                                 "precision", "structure"}));
}

TEST(ReportJsonTest, ThePageIsOfSixtyLinesAtMost) {
  // As many targets, cells and reasons as a whole run on any machine has.
  Json report = Report();
  Json& sections = report.at("sections");
  Json& targets = sections.at("crossover").at("targets");
  targets = Json(std::vector<Json>(5, targets[0]));
  Json& cells = sections.at("sweep").at("cells");
  const Json cell = cells[0];
  cells = Json::array();
  for (const double size : {0.001, 0.003, 0.01, 0.03, 0.1, 0.3}) {
    for (const int objects : {1000, 10000, 100000}) {
      cells.push_back(cell);
      cells.back()["size"] = size;
      cells.back()["objects"] = objects;
    }
  }
  sections.at("answers").at("not_reached") = {
      "L3: this machine has no such cache",
      "memory: needs 1024 MiB, more than a quarter of the 512 MiB free",
      "threads: this run may use one CPU"};
  Json& kernels = sections["kernels"]["rows"];
  for (const char* set : {"L1", "L2", "L3", "memory"}) {
    for (const char* shape : {"aabb", "simplex", "aabo"}) {
      kernels.push_back({{"shape", shape},
                         {"schedule", "flat"},
                         {"working_set", set},
                         {"target", std::string(ChosenTarget().name())},
                         {"ns_per_object", 0.5},
                         {"ns_quartiles", {0.4, 0.6}}});
    }
  }
  std::ostringstream page;
  WritePage(page, report.dump());
  const std::string text = page.str();
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 60) << text;
  for (const char* part : {"What to use", "w*", "break-even", "noise",
                           "volumes", "dimensions", "dual", "axes"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(text.find(" \n"), std::string::npos);
}

TEST(ReportJsonTest, AnythingElseIsNoPage) {
  for (const char* json :
       {"", "{", "[]", "{}", R"({"schema": "3"})", R"({"schema": 3})",
        R"({"schema": 3, "context": {"cpu": 1}, "sections": {}})"}) {
    std::ostringstream page;
    EXPECT_THROW(WritePage(page, json), std::invalid_argument) << json;
  }
}

}  // namespace
}  // namespace halfspace::bench
