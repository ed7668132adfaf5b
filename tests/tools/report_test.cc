// The writers of reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

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

}  // namespace
}  // namespace halfspace::bench
