// Small parts of the tool, each against values by hand; the writers of reports;
// and the rule of the verdict: what a range of groups promises, where a ratio
// crosses 1, and the lines that say so.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/base/text.h"
#include "bench/inner/target_loops.h"
#include "bench/measure/groups.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/measure/probes.h"
#include "bench/measure/team.h"
#include "bench/report/table.h"
#include "bench/sections/verdict.h"
#include "bench/worlds/random.h"
#include "bench/worlds/working_set.h"
#include "halfspace/targets.h"

namespace halfspace::bench {
namespace {

TEST(TeamTest, RunsEachThreadOnceAndRethrows) {
  std::vector<int> runs(3);
  const TeamTime time = RunTeam(3, [&](std::size_t i) { ++runs[i]; });
  EXPECT_EQ(runs, (std::vector<int>{1, 1, 1}));
  EXPECT_GT(time.seconds, 0.0);
  EXPECT_LE(time.cpu_share, 1.0);
  EXPECT_THROW(RunTeam(2,
                       [](std::size_t i) {
                         if (i == 1) throw std::runtime_error("over there");
                       }),
               std::runtime_error);
}

// Ratios of times of 0 were NaN, and were printed.
TEST(MeasureTest, RefusesATimeOfZero) {
  Case nothing;
  nothing.name = "nothing";
  nothing.items = std::numeric_limits<double>::infinity();
  nothing.run = [] {};
  EXPECT_THROW(Measure({nothing}, {.repetitions = 1}), std::runtime_error);
}

// The ceilings of scans and builders: they must move every byte.
TEST(TargetLoopsTest, ReadsEveryByte) {
  constexpr std::size_t kFloats = 40 * kReadBytes / sizeof(float);
  for (std::size_t count : {4u, 6u, 8u}) {
    std::vector<std::vector<float>> planes(count,
                                           std::vector<float>(kFloats, 0));
    std::vector<const float*> list;
    for (const auto& plane : planes) list.push_back(plane.data());
    for (Target target : SupportedTargets()) {
      // By words, in turns that do not divide a plane, and by planes.
      for (std::size_t turn :
           {kReadBytes, 3 * kReadBytes, kFloats * sizeof(float)}) {
        SCOPED_TRACE(std::string(target.name()) + ", " + std::to_string(turn));
        const auto read = [&] {
          return LoopsFor(target).read(turn, list.data(), count,
                                       kFloats * sizeof(float));
        };
        EXPECT_EQ(read(), 0u);
        for (std::size_t p = 0; p < count; ++p) {
          // A float of each chunk, another one each time.
          for (std::size_t i = p; i < kFloats; i += kReadBytes / 4 - 1) {
            planes[p][i] = 1;
            EXPECT_NE(read(), 0u) << p << ", " << i;
            planes[p][i] = 0;
          }
        }
      }
    }
  }
}

TEST(TargetLoopsTest, CopiesEveryByte) {
  struct alignas(64) Lines {
    std::array<std::uint32_t, 3 * 64> words;
  };
  Lines from;
  std::iota(from.words.begin(), from.words.end(), 1u);
  for (Target target : SupportedTargets()) {
    for (bool streamed : {false, true}) {
      Lines to{};
      LoopsFor(target).copy(streamed, from.words.data(), to.words.data(), 128);
      for (std::size_t i = 0; i < to.words.size(); ++i) {
        EXPECT_EQ(to.words[i], i < 128 ? from.words[i] : 0) << target.name();
      }
    }
  }
}

// "This was a quiet run" was printed next to "other programs take 85 % of a
// CPU".
TEST(LoadTest, ARunNextToOtherProgramsIsNotQuiet) {
  struct Row {
    Load load;
    int cpus;
    bool is_loaded;
  };
  for (const Row& row : std::vector<Row>{{{1.0, 0.0, {}}, 2, false},
                                         {{0.99, 5.0, 0.1}, 2, false},
                                         {{1.0, 0.0, 0.85}, 2, true},
                                         {{1.0, 0.0, 0.85}, 16, false},
                                         {{0.6, 0.0, {}}, 16, true},
                                         {{0.97, 100.0, 0.0}, 2, true}}) {
    EXPECT_EQ(IsLoaded(row.load, row.cpus), row.is_loaded)
        << row.load.cpu_share << ' ' << row.load.interruptions << ' '
        << row.load.others.value_or(-1.0);
  }
  // A thread that waits has no CPU.
  const LoadProbe probe;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_LT(probe.Sample().cpu_share, 0.5);
}

TEST(PrintableTest, EscapesControlCharactersAndLeavesLetters) {
  EXPECT_EQ(Printable("a\n\x1b[31m\x7f"), "a\\x0a\\x1b[31m\\x7f");
  EXPECT_EQ(Printable("\xC3\x9F"), "\xC3\x9F");     // U+00DF
  EXPECT_EQ(Printable("\xC2\x9Bm"), "\xC2\\x9bm");  // U+009B
}

// A virtual machine that hides its caches had 32 MiB of "memory".
TEST(WorkingSetTest, MemoryIsMemoryOnAnyMachine) {
  constexpr std::size_t kMebibyte = std::size_t{1} << 20;
  struct Row {
    std::vector<Cache> caches;
    std::size_t bytes;  // of the simplex
  };
  for (const Row& row : std::vector<Row>{
           {{}, 256 * kMebibyte},
           {{{1, 32 << 10, 1}, {2, kMebibyte, 1}}, 256 * kMebibyte},
           {{{3, 32 * kMebibyte, 8}}, 256 * kMebibyte},
           {{{3, 96 * kMebibyte, 8}}, 384 * kMebibyte}}) {
    Machine machine;
    machine.caches = row.caches;
    const WorkingSetSize memory = WorkingSetSizes(machine).back();
    EXPECT_EQ(memory.name, "memory");
    EXPECT_EQ(memory.bytes, row.bytes);
    EXPECT_GE(memory.objects * 4 * sizeof(float), row.bytes);
  }
}

// ---- Reports.

Report Example() {
  Table speed{"speed",
              "of two shapes",
              {Key("shape"), Key("w"), Lower("time", "ns", 3),
               Higher("times as fast"), Value("remark")}};
  speed.Add({"AABB", std::size_t{16}, 1.5, Ratio{1.25, 1.0, 1.5},
             Cell("slow").With(Flag::kTie)});
  speed.Add({"simplex \"<&\n",
             std::size_t{65536},
             Cell(),
             Cell(Ratio{2.0, 1.75, 2.5}).With(Flag::kWinner),
             {}});
  speed.notes = {"A note."};
  speed.chart = Chart{"w", {"time"}, "shape", true, false, {{"AABB", 2.5}}};
  speed.lead = {"  A line."};
  return {{{"cpu", "a CPU"}, {"scope", "--quick"}}, {speed}};
}

std::string TextOf(const Table& table) {
  std::ostringstream out;
  WriteText(out, table);
  return out.str();
}

std::size_t WidestOf(const std::string& text) {
  std::istringstream lines(text);
  std::size_t widest = 0;
  for (std::string line; std::getline(lines, line);) {
    widest = std::max(widest, line.size());
  }
  return widest;
}

TEST(TextTest, AlignsNumbersRightAndTextLeft) {
  EXPECT_EQ(TextOf(Example().tables[0]),
            "\nspeed: of two shapes\n\n"
            "  shape                 w  time, ns        times as fast  remark\n"
            "  AABB                 16     1.500    1.25 [1.00, 1.50]  slow =\n"
            "  simplex \"<&\\x0a  65 536         -  2.00 [1.75, 2.50] *  -\n"
            "\n  A note.\n");
}

TEST(TextTest, WrapsWhatIsTooWide) {
  Table table{"wide", "a table", {Key("what"), Value("number")}};
  const std::string words(30, 'a');
  table.Add({words + " " + words + " " + words + " " + words, 1.0});
  for (int i = 0; i < 20; ++i) table.notes.push_back("many words " + words);
  table.notes.push_back(TextOf(table));
  EXPECT_LE(WidestOf(TextOf(table)), 80u);
}

// The names of columns wrap first, and then each range has a line of its own.
TEST(TextTest, PutsRangesBelowTheirValuesInAWideTable) {
  const auto table_of = [](std::size_t columns) {
    Table table{"wide", "a table", {Key("size")}};
    Row row = {1.0};
    for (std::size_t c = 0; c < columns; ++c) {
      table.columns.push_back(Value("of a target, 8"));
      row.push_back(Cell(Ratio{1.15, 1.11, 1.16}).With(Flag::kWinner));
    }
    table.Add(row);
    return TextOf(table);
  };
  EXPECT_NE(table_of(3).find("1.15 [1.11, 1.16] *"), std::string::npos);
  const std::string wide = table_of(5);
  EXPECT_LE(WidestOf(wide), 80u);
  EXPECT_NE(wide.find("        1.15 *        1.15 *"), std::string::npos)
      << wide;
  EXPECT_NE(wide.find("  [1.11, 1.16]  [1.11, 1.16]"), std::string::npos)
      << wide;
}

TEST(TextTest, LeavesOutWhatIsEmpty) {
  EXPECT_EQ(TextOf({"nothing", "here", {Key("a")}}), "");
}

// page_test.py compares it with docs/report.schema.json.
TEST(JsonTest, HasALineForEachRow) {
  const std::string json = ToJson(Example());
  for (const char* line :
       {R"({"schema":4,)", R"( "scope": "--quick")",
        R"(["AABB",16,1.5,[1.25,1,1.5],["slow",null,null,"tie"]],)",
        R"(["simplex \"<&\n",65536,null,[2,1.75,2.5,"winner"],null]]}]})"}) {
    EXPECT_NE(("\n" + json).find(std::string("\n") + line + "\n"),
              std::string::npos)
        << line << '\n'
        << json;
  }
  for (const char* part :
       {R"("lead":["  A line."])", R"("notes":["A note."])",
        R"("marks":[["AABB",2.5]])",
        R"({"name":"shape","key":true,"digits":0})",
        R"({"name":"time","unit":"ns","better":"lower","digits":3})"}) {
    EXPECT_NE(json.find(part), std::string::npos) << part << '\n' << json;
  }
}

TEST(JsonTest, KeepsCountsAndFiveDigits) {
  Table table{"t", "", {Value("a"), Value("b"), Value("c")}};
  table.Add({std::size_t{4194304}, 0.12345678, 1.0 / 0.0});
  EXPECT_NE(ToJson(Report{{}, {table}}).find("[4194304,0.12346,null]"),
            std::string::npos);
}

// ---- The verdict.

TEST(VerdictTest, ClaimsAWinnerOnlyOutsideTheRange) {
  EXPECT_EQ(WinnerOf(RangeOf({1.2, 1.01, 1.3})), Winner::kSimplex);
  EXPECT_EQ(WinnerOf(RangeOf({0.9, 0.8, 0.99})), Winner::kBox);
  EXPECT_EQ(WinnerOf(RangeOf({1.2, 1.3, 0.99})), Winner::kNone);
  EXPECT_EQ(WinnerOf(RangeOf({1.0, 1.0, 1.0})), Winner::kNone);
}

TEST(VerdictTest, ChoosesAScheduleInOneHalfOfTheRepetitions) {
  struct Row {
    std::vector<std::vector<double>> samples;
    double expected;
  };
  for (const Row& row : std::vector<Row>{
           {{{1.0}}, 1.0},
           {{{3.0}, {2.0}}, 2.0},
           // The second one is better in both halves.
           {{{2.0, 2.0, 2.0, 2.0}, {1.0, 1.5, 1.0, 1.5}}, 1.25},
           // Two runs of one kernel. The luckier of the two medians is 2.0.
           {{{1.0, 3.0}, {3.0, 1.0}}, 3.0},
           // The median of a half leaves out what disturbed one repetition.
           {{{9.0, 1.0, 1.0, 1.0, 1.0, 1.0}}, 1.0}}) {
    EXPECT_EQ(BestTime(row.samples), row.expected);
  }
}

TEST(VerdictTest, BothBoundsChooseFromEquallyManySchedules) {
  std::array<std::set<Schedule>, 3> schedules;
  for (const Contender& contender : kContenders) {
    EXPECT_TRUE(schedules[static_cast<std::size_t>(contender.shape)]
                    .insert(contender.how)
                    .second);
  }
  EXPECT_EQ(schedules[0], schedules[1]);
  EXPECT_EQ(schedules[0].size(), 3u);
}

TEST(VerdictTest, ComparesShapesGroupByGroup) {
  VerdictWorld world;
  world.objects = 100;
  world.survivors.assign(3, {.aabb = 1.0, .simplex = 2.0, .aabo = 1.0});
  world.times = {{{{}, 1.0, 2.0}, {{}, 2.0, 3.0}, {{}, 1.0, 1.5}}};
  const Ratio ratio = world.BoxOverSimplex(0, 0.0);
  EXPECT_EQ(ratio.low, 1.5);
  EXPECT_EQ(ratio.median, 1.5);
  EXPECT_EQ(ratio.high, 2.0);
  // Exact tests of 100 ns: 1 ns an object more for the box, 2 for the simplex.
  EXPECT_NEAR(world.BoxOverSimplex(0, 100.0).median, 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(world.MeanSurvivors().simplex, 2.0);
}

// What a range promises, for groups that differ in nothing but chance.
TEST(GroupsTest, RangesKeepTheirPromise) {
  struct Row {
    std::vector<double> groups;
    Ratio expected;
  };
  for (const Row& row :
       std::vector<Row>{{{2.0}, {2.0, 2.0, 2.0}},
                        {{3.0, 1.0}, {2.0, 1.0, 3.0}},
                        {{5.0, 1.0, 2.0}, {2.0, 1.0, 5.0}},
                        // Of ten groups one on each side is left out.
                        {{9.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 0.5},
                         {2.0, 1.0, 3.0}},
                        {{kInfinity, 1.0, kInfinity, kInfinity},
                         {kInfinity, 1.0, kInfinity}},
                        {{0.0, 0.0, 0.0, kInfinity}, {0.0, 0.0, kInfinity}}}) {
    const Ratio range = GroupRange(row.groups);
    EXPECT_EQ(range.median, row.expected.median);
    EXPECT_EQ(range.low, row.expected.low);
    EXPECT_EQ(range.high, row.expected.high);
  }
  // The tables of `--details verdict`: 7 sizes, 5 columns, with and without
  // exact tests.
  EXPECT_LT(2 * 7 * 5 * kFalseWinnerChance, 0.05);
  Random random(1);
  const auto run = [&random] {
    std::vector<double> groups(kGroups);
    for (double& group : groups) group = random.Signed();
    return GroupRange(groups);
  };
  constexpr int kRuns = 10'000;
  int covered = 0;
  int excluded = 0;
  for (int i = 0; i < kRuns; ++i) {
    const Ratio range = run();
    const double median = run().median;
    covered += range.low <= median && median <= range.high ? 1 : 0;
    excluded += range.low > 0.0 || range.high < 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(covered / double{kRuns}, 0.99, 0.005);
  EXPECT_NEAR(excluded / double{kRuns}, kFalseWinnerChance, 0.0005);
}

// A ratio of straight lines between logarithms, as its points say.
struct Curve {
  std::vector<std::pair<double, double>> points;
  double operator()(double size) const {
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (size > points[i].first) continue;
      const double part = std::log(size / points[i - 1].first) /
                          std::log(points[i].first / points[i - 1].first);
      return points[i - 1].second *
             std::pow(points[i].second / points[i - 1].second, part);
    }
    return points.back().second;
  }
};

TEST(CrossingTest, FindsWhereARatioIsAboveOne) {
  struct Row {
    const char* what;
    Curve curve;
    SizeSpan expected;
  };
  const std::vector<double> sizes = {0.1, 1.0, 10.0, 30.0};
  for (const Row& row : std::vector<Row>{
           {"crosses once", {{{0.1, 0.5}, {10.0, 2.0}}}, {1.0, kInfinity}},
           // A line between the rows 1 and 10 would say 3.4.
           {"is steep beside a row",
            {{{0.1, 0.5}, {1.0, 0.8}, {1.2, 1.25}, {10.0, 1.5}, {30.0, 1.5}}},
            {std::sqrt(1.2), kInfinity}},
           {"is above at all sizes",
            {{{0.1, 1.1}, {30.0, 1.5}}},
            {0.0, kInfinity}},
           {"is above at no size",
            {{{0.1, 0.5}, {30.0, 1.0}}},
            {kInfinity, 0.0}},
           {"ends, as with exact tests",
            {{{0.1, 0.5}, {10.0, 2.0}, {30.0, 0.5}}},
            {1.0, std::sqrt(10.0 * 30.0)}},
           {"falls", {{{0.1, 2.0}, {10.0, 0.5}}}, {0.0, 1.0}},
           {"is above twice: the greater one counts",
            {{{0.1, 1.1}, {1.0, 0.5}, {10.0, 2.0}, {30.0, 2.0}}},
            {std::sqrt(10.0), kInfinity}}}) {
    const SizeSpan span = FindSpan(sizes, row.curve);
    const auto expect_near = [&](double value, double expected) {
      if (std::isfinite(expected)) {
        EXPECT_NEAR(value, expected, 0.02 * expected) << row.what;
      } else {
        EXPECT_EQ(value, expected) << row.what;
      }
    };
    expect_near(span.from, row.expected.from);
    expect_near(span.to, row.expected.to);
  }
}

const std::vector<double> kLeadSizes = {0.1, 1.0, 30.0};
const Ratio kAbove = {kInfinity, kInfinity, kInfinity};  // beyond 30 %
const Ratio kBelow = {0.0, 0.0, 0.0};                    // below 0.1 %

TEST(LeadTest, NamesTheSizesOfATarget) {
  const Ratio one = {1.0, 0.9, 1.1};
  struct Row {
    Crossings crossings;
    std::string simplex;
    std::string box_again;
  };
  const std::string of = " of the world's side";
  const std::string every = "(at every size measured, 0.1 to 30 %)";
  const std::string none = "(at no size measured, 0.1 to 30 %)";
  for (const Row& row : std::vector<Row>{
           {{{3.41, 3.06, 3.8}, kAbove}, "3.4 % [3.1, 3.8]" + of, none},
           {{{0.842, 0.7, 1.0}, kAbove}, "0.84 % [0.7, 1]" + of, none},
           {{{0.15, 0.0, 0.2}, kAbove}, "0.15 % [< 0.1, 0.2]" + of, none},
           {{{0.0, 0.0, 0.2}, kAbove}, "< 0.1 % [< 0.1, 0.2]" + of, none},
           {{{12.3, 9.9, kInfinity}, kAbove}, "12 % [9.9, > 30]" + of, none},
           {{one, {20.0, 15.0, 25.0}},
            "1 % [0.9, 1.1]" + of + ", up to 20 % [15, 25]",
            "20 % [15, 25]" + of},
           {{one, {6.04, 5.2, 7.1}},
            "1 % [0.9, 1.1]" + of + ", up to 6 % [5.2, 7.1]",
            "6 % [5.2, 7.1]" + of},
           {{kBelow, kAbove}, every, none},
           {{kAbove, kBelow}, none, every}}) {
    EXPECT_EQ(SimplexText(row.crossings, kLeadSizes), row.simplex);
    EXPECT_EQ(BoxAgainText(row.crossings, kLeadSizes), row.box_again);
  }
}

// "The simplex wins on no target" stood above "AVX2: the simplex wins".
TEST(LeadTest, OfAFileSaysWhatItsRowsSay) {
  EXPECT_EQ(RatioText({0.7, 0.65, 0.8}),
            "0.70 [0.65, 0.80]: the box is faster");
  EXPECT_EQ(RatioText({1.01, 0.98, 1.03}), "1.01 [0.98, 1.03]: no difference");
  EXPECT_EQ(RatioText({1.15, 1.11, 1.16}),
            "1.15 [1.11, 1.16]: the simplex is faster");
}

}  // namespace
}  // namespace halfspace::bench
