// The writers of reports, and the comparison of two.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/report/table.h"

namespace halfspace::bench {
namespace {

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

TEST(TextTest, WritesTheLeadAsItIsBeforeTheTable) {
  Table table{"t", "a table", {Key("a")}};
  table.lead = {"A heading", "  a       1",
                std::string(50, 'a') + " " + std::string(50, 'b')};
  std::ostringstream out;
  WriteLead(out, table);
  EXPECT_EQ(out.str(), "A heading\n  a       1\n" + std::string(50, 'a') +
                           "\n" + std::string(50, 'b') + "\n");
}

TEST(TextTest, LeavesOutWhatIsEmpty) {
  EXPECT_EQ(TextOf({"nothing", "here", {Key("a")}}), "");
}

TEST(JsonTest, IsReadAsItWasWritten) {
  const Report report = Example();
  const Report read = ReportFromJson(ToJson(report));
  EXPECT_EQ(read.context, report.context);
  ASSERT_EQ(read.tables.size(), 1u);
  EXPECT_EQ(read.tables[0].rows, report.tables[0].rows);
  EXPECT_EQ(read.tables[0].notes, report.tables[0].notes);
  ASSERT_TRUE(read.tables[0].chart.has_value());
  EXPECT_EQ(read.tables[0].chart->series, "shape");
  EXPECT_EQ(read.tables[0].chart->marks, report.tables[0].chart->marks);
  EXPECT_EQ(read.tables[0].lead, report.tables[0].lead);
  EXPECT_EQ(ToJson(read), ToJson(report));
}

TEST(JsonTest, KeepsCountsAndFiveDigits) {
  Table table{"t", "", {Value("a"), Value("b"), Value("c")}};
  table.Add({std::size_t{4194304}, 0.12345678, 1.0 / 0.0});
  const Report read = ReportFromJson(ToJson(Report{{}, {table}}));
  EXPECT_EQ(read.tables[0].rows[0][0].value, 4194304.0);
  EXPECT_EQ(read.tables[0].rows[0][1].value, 0.12346);
  EXPECT_EQ(read.tables[0].rows[0][2].value, std::nullopt);
}

// They said whether a value met an aim.
TEST(JsonTest, ReadsReportsOfOlderVersions) {
  std::string text = ToJson(Example());
  const std::size_t at = text.find("\"winner\"");
  ASSERT_NE(at, std::string::npos);
  const Report read = ReportFromJson(text.replace(at, 8, "\"missed\""));
  EXPECT_EQ(read.tables[0].rows[1][3].flag, Flag::kNone);
  EXPECT_EQ(read.tables[0].rows[1][3].value, 2.0);
}

TEST(JsonTest, RefusesWhatIsNoReport) {
  const std::string good = ToJson(Example());
  const auto with = [&good](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const std::string deep = std::string(50000, '[') + std::string(50000, ']');
  std::string deep_object;
  for (int i = 0; i < 50000; ++i) deep_object += "{\"a\":";
  deep_object += "1" + std::string(50000, '}');
  for (const std::string& bad :
       {std::string(), std::string("[]"), std::string("{\"schema\": 4}"), deep,
        deep_object, with("\"a CPU\"", deep), with("\"a CPU\"", deep_object),
        with("\"tie\"", deep), with("\"AABB\"", deep),
        good.substr(0, good.size() / 2), with("\"schema\":4", "\"schema\":3"),
        with("\"AABB\",", ""), with("\"lower\"", "\"best\""),
        with("\"digits\":3", "\"digits\":1e18"), with("\"tie\"", "[]"),
        std::string(100000, '[')}) {
    EXPECT_THROW(ReportFromJson(bad), std::invalid_argument)
        << bad.substr(0, 200);
  }
}

Report WithTime(double time, double low, double high) {
  Report report = Example();
  report.tables[0].rows[0][2] = Ratio{time, low, high};
  return report;
}

TEST(CompareTest, FindsWhatIsWorseByMoreThanATenthAndItsSpread) {
  const Report stored = WithTime(1.0, 0.9, 1.1);
  EXPECT_TRUE(Compare(stored, WithTime(1.09, 1.2, 1.2)).worse.empty());
  EXPECT_TRUE(Compare(stored, WithTime(1.3, 1.05, 1.5)).worse.empty());
  EXPECT_TRUE(Compare(stored, WithTime(0.5, 0.5, 0.5)).worse.empty());
  const Comparison worse = Compare(stored, WithTime(1.3, 1.2, 1.5));
  EXPECT_EQ(worse.compared, 3u);
  EXPECT_EQ(worse.worse, (std::vector<std::string>{
                             "speed, AABB, 16.000000: time 1.300, was 1.000"}));
  EXPECT_EQ(worse.tables, std::vector<std::string>{"speed"});
  Report slower = Example();
  slower.tables[0].rows[1][3] = Ratio{1.5, 1.4, 1.6};
  EXPECT_EQ(Compare(Example(), slower).worse.size(), 1u);
}

TEST(CompareTest, ComparesRowsAndColumnsOfTheSameNameAlone) {
  Report other = Example();
  other.tables[0].rows[0][0] = "AABO";
  EXPECT_EQ(Compare(Example(), other).compared, 1u);
  other.tables[0].name = "other";
  EXPECT_EQ(Compare(Example(), other).compared, 0u);
  Report fewer = Example();
  fewer.tables[0].columns[3].name = "renamed";
  EXPECT_EQ(Compare(Example(), fewer).compared, 1u);
}

}  // namespace
}  // namespace halfspace::bench
