// What the section throughput prints, and what it computes from times.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/base/text_table.h"
#include "bench/baselines/register_scan.h"
#include "bench/measure/crossover_size.h"
#include "bench/measure/line_fit.h"
#include "bench/measure/two_threads.h"
#include "bench/report/report.h"
#include "bench/sections/throughput.h"
#include "halfspace/reject.h"

#if defined(__GLIBC__)
#include <pthread.h>
#include <sched.h>
#endif

namespace halfspace::bench {
namespace {

using Json = nlohmann::json;

ThroughputResult SomeResult() {
  ThroughputResult result;
  ThroughputRow row;
  row.name = "read simplex by-word";
  row.objects = 4096;
  row.queries = 1;
  row.working_set = "memory";
  row.target = "SSE4";
  row.ns_per_pair = 0.5;
  result.rows.push_back(row);
  row.name = "simplex flat";
  row.ceiling = 0;
  row.percent_of_ceiling = 98.0;
  result.rows.push_back(row);
  row.name = "baseline";
  row.target.clear();
  result.rows.push_back(row);
  result.ratios.push_back(
      {1, "a share", 98.0, 97.0, true, Ratio{98.0, 97.5, 98.5}});
  result.ratios.push_back({6, "a cost", 1.2, 1.15, false});
  result.not_reached.push_back("threshold 8: no competitors");
  return result;
}

Json Section(const ThroughputResult& result) {
  Results results;
  results.throughput = result;
  return Json::parse(ToJson(results)).at("sections").at("throughput");
}

TEST(ThroughputReportTest, JsonHasTheFixedForm) {
  ThroughputResult result = SomeResult();
  const Json section = Section(result);
  const Json& row = section.at("rows").at(1);
  EXPECT_EQ(row.at("name"), "simplex flat");
  EXPECT_EQ(row.at("objects"), 4096);
  EXPECT_EQ(row.at("queries"), 1);
  EXPECT_EQ(row.at("working_set"), "memory");
  EXPECT_EQ(row.at("target"), "SSE4");
  EXPECT_EQ(row.at("ns_per_pair"), 0.5);
  EXPECT_EQ(row.at("ceiling"), "read simplex by-word");
  EXPECT_EQ(row.at("percent_of_ceiling"), 98.0);
  EXPECT_TRUE(section.at("rows").at(0).at("ceiling").is_null());
  EXPECT_TRUE(section.at("rows").at(0).at("percent_of_ceiling").is_null());
  EXPECT_TRUE(section.at("rows").at(2).at("target").is_null());
  EXPECT_EQ(section.at("ratios").at(0), Json({{"threshold", 1},
                                              {"name", "a share"},
                                              {"value", 98.0},
                                              {"needed", 97.0},
                                              {"better", "higher"},
                                              {"met", true},
                                              {"quartiles", {97.5, 98.5}}}));
  EXPECT_EQ(section.at("ratios").at(1).at("better"), "lower");
  EXPECT_EQ(section.at("ratios").at(1).at("met"), false);
  EXPECT_TRUE(section.at("ratios").at(1).at("quartiles").is_null());
  EXPECT_TRUE(section.at("survivors").is_null());
  EXPECT_EQ(section.at("not_reached").size(), 1u);
  result.survivors = PerShape<std::size_t>{1, 2, 3};
  EXPECT_EQ(Section(result).at("survivors"),
            Json({{"aabb", 1}, {"simplex", 2}, {"aabo", 3}}));
}

TEST(ThroughputReportTest, TextSaysWhichAimsAreMet) {
  std::ostringstream text;
  WriteText(text, SomeResult());
  EXPECT_NE(text.str().find("a share met     98.00  >= 97.00"),
            std::string::npos)
      << text.str();
  EXPECT_NE(text.str().find("a cost  missed   1.20   <= 1.15"),
            std::string::npos)
      << text.str();
  EXPECT_NE(text.str().find("1 of 2 aims are met"), std::string::npos);
  EXPECT_NE(text.str().find("docs/performance.md"), std::string::npos);
  EXPECT_NE(text.str().find("not reached: threshold 8"), std::string::npos);
  // To miss an aim is no failure.
  EXPECT_EQ(text.str().find("FAIL"), std::string::npos) << text.str();
}

TEST(ThroughputReportTest, TextExplainsOnlyWhatIsThere) {
  ThroughputResult all_met = SomeResult();
  all_met.ratios.pop_back();
  std::ostringstream text;
  WriteText(text, all_met);
  EXPECT_NE(text.str().find("1 of 1 aims are met.\n"), std::string::npos)
      << text.str();
  EXPECT_EQ(text.str().find("performance.md"), std::string::npos);
  std::ostringstream none;
  WriteText(none, ThroughputResult());
  EXPECT_EQ(none.str().find("aims are met"), std::string::npos) << none.str();
}

TEST(ThroughputReportTest, AnAimIsMetAtItsLimit) {
  EXPECT_TRUE((ThroughputRatio{1, "", 97.0, 97.0, true}.is_met()));
  EXPECT_FALSE((ThroughputRatio{1, "", 96.9, 97.0, true}.is_met()));
  EXPECT_TRUE((ThroughputRatio{6, "", 1.15, 1.15, false}.is_met()));
  EXPECT_FALSE((ThroughputRatio{6, "", 1.16, 1.15, false}.is_met()));
}

TEST(OtherThreadTest, HandsOverWhatTheWorkThrows) {
  OtherThread other([] { throw std::runtime_error("over there"); });
  other.Start();
  EXPECT_THROW(other.Wait(), std::runtime_error);
}

// What sections add to a result, without anything timed.
struct Sink {
  Progress progress;
  std::vector<Timing> timings;
  Context context{{ChosenTarget()}, {}, progress, timings};
  ThroughputResult result;
  Throughput throughput{context, true, result};
};

TEST(ThroughputTest, ARowKnowsItsCeilingWhateverItsName) {
  Sink sink;
  const Target target = ChosenTarget();
  const auto row = [](double ns) {
    ThroughputRow made;
    made.name = "read simplex";
    made.ns_per_pair = ns;
    return made;
  };
  const Ceiling ceiling{Ceiling::Kind::kRead, ShapeKind::kSimplex, "L3",
                        target};
  Ceiling other_set = ceiling;
  other_set.working_set = "memory";
  Ceiling other_kind = ceiling;
  other_kind.kind = Ceiling::Kind::kReadQuantized;
  Ceiling other_shape = ceiling;
  other_shape.shape = ShapeKind::kAabo;
  sink.throughput.AddCeiling(ceiling, row(1.0));
  sink.throughput.AddCeiling(other_set, row(2.0));
  sink.throughput.AddCeiling(other_kind, row(3.0));
  sink.throughput.AddRow(row(4.0));
  sink.throughput.AddRowUnder(ceiling, row(5.0));
  EXPECT_EQ(sink.result.rows.back().ceiling, 0u);
  EXPECT_EQ(sink.result.rows.back().percent_of_ceiling, 20.0);
  sink.throughput.AddRowUnder(other_kind, row(5.0));
  EXPECT_EQ(sink.result.rows.back().ceiling, 2u);
  sink.throughput.AddRowUnder(other_shape, row(5.0));
  EXPECT_EQ(sink.result.rows.back().ceiling, std::nullopt);
  EXPECT_EQ(sink.result.rows.back().percent_of_ceiling, std::nullopt);
}

TEST(ThroughputTest, ARatioHasTheThresholdOfItsTarget) {
  for (Target target : SupportedTargets()) {
    Sink sink;
    sink.throughput.AddRatio(thresholds::kReading, target, "a share", 90.0);
    ASSERT_EQ(sink.result.ratios.size(), 1u);
    const ThroughputRatio& ratio = sink.result.ratios[0];
    EXPECT_EQ(ratio.threshold, 1);
    EXPECT_EQ(ratio.needed, IsAvx512(target) || IsAvx2(target) ? 97.0 : 90.0)
        << target.name();
    EXPECT_EQ(ratio.is_met(), ratio.needed == 90.0);
  }
}

#if defined(__GLIBC__)
void ExpectTwoThreadsNotReached(const std::string& why) {
  Workload workload;
  workload.objects.Push(Aabo3::Everything());
  workload.queries.push_back(Aabo3::Everything());
  Sink sink;
  ThroughputParts parts;
  AddOutputParts(workload, parts);
  parts.back()(sink.throughput);
  EXPECT_TRUE(sink.result.ratios.empty());
  ASSERT_EQ(sink.result.not_reached.size(), 1u);
  EXPECT_NE(sink.result.not_reached[0].find(why), std::string::npos)
      << sink.result.not_reached[0];
}

TEST(TwoThreadsTest, AreNotReachedOnOneOfManyCpus) {
  cpu_set_t all;
  ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
  ExpectTwoThreadsNotReached("one CPU");
  ASSERT_EQ(sched_setaffinity(0, sizeof(all), &all), 0);
}

TEST(TwoThreadsTest, AreNotReachedWhereNoThreadCanBeStarted) {
  if (UsableCpus() < 2) GTEST_SKIP() << "one CPU";
  pthread_attr_t usual;
  pthread_attr_t huge;
  ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
  ASSERT_EQ(pthread_getattr_default_np(&huge), 0);
  // A stack that no address space has room for.
  ASSERT_EQ(pthread_attr_setstacksize(&huge, std::size_t{1} << 60), 0);
  ASSERT_EQ(pthread_setattr_default_np(&huge), 0);
  ExpectTwoThreadsNotReached("no thread can be started");
  ASSERT_EQ(pthread_setattr_default_np(&usual), 0);
}
#endif

TEST(PrintableTest, EscapesControlCharactersAndLeavesLetters) {
  EXPECT_EQ(Printable("a\n\x1b[31m\x7f"), "a\\x0a\\x1b[31m\\x7f");
  EXPECT_EQ(Printable("\xC3\x9F"), "\xC3\x9F");     // U+00DF
  EXPECT_EQ(Printable("\xC2\x9Bm"), "\xC2\\x9bm");  // U+009B
}

TEST(LineFitTest, FindsInterceptAndSlope) {
  const std::vector<double> x = {64, 128, 1024};
  const std::vector<double> exact = {7 + 64 * 0.5, 7 + 128 * 0.5,
                                     7 + 1024 * 0.5};
  EXPECT_NEAR(FitLine(x, exact).intercept, 7.0, 1e-9);
  EXPECT_NEAR(FitLine(x, exact).slope, 0.5, 1e-12);
  // By hand: means 2 and 3, slope (1 * 2 + 0 + 1 * 1) / 2.
  const std::vector<double> few = {1, 2, 3};
  const std::vector<double> scattered = {1, 4, 4};
  EXPECT_NEAR(FitLine(few, scattered).slope, 1.5, 1e-12);
  EXPECT_NEAR(FitLine(few, scattered).intercept, 0.0, 1e-12);
}

TEST(CrossoverSizeTest, InterpolatesBetweenLogarithms) {
  const std::vector<double> sizes = {100, 10000};
  const std::vector<double> ours = {1, 100};
  // Half of theirs, then twice as much: in the middle.
  const std::vector<double> theirs = {2, 50};
  EXPECT_NEAR(CrossoverSize(sizes, ours, theirs), 1000, 1e-6);
  const std::vector<double> faster = {0.5, 200};
  EXPECT_EQ(CrossoverSize(sizes, ours, faster), 0.0);
  const std::vector<double> slower = {2, 200};
  EXPECT_EQ(CrossoverSize(sizes, ours, slower), 10000.0);
}

TEST(RegisterScanTest, WritesTheWordsAndNoMore) {
  AaboWorld3 world;
  world.Resize(256);
  const Aabo3 query = Aabo3::Empty();
  for (Target target : SupportedTargets()) {
    const RegisterScans scans = RegisterScansFor(target);
    for (RegisterScan scan : {scans.one, scans.many}) {
      if (scan == nullptr) continue;
      for (ShapeKind shape : kShapes) {
        constexpr std::uint64_t kUntouched = 0x5555555555555555;
        std::vector<std::uint64_t> mask(6, kUntouched);
        scan(shape, PlanesOf(shape, world.view()).data(),
             QueryOf(shape, query).data(), 256, mask.data());
        for (std::size_t w = 0; w < 4; ++w) {
          EXPECT_NE(mask[w], kUntouched) << target.name() << NameOf(shape);
        }
        EXPECT_EQ(mask[4], kUntouched);
        EXPECT_EQ(mask[5], kUntouched);
      }
    }
  }
}

}  // namespace
}  // namespace halfspace::bench
