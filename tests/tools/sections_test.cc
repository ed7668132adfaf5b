// Small runs: what the page begins with. page_test.py looks at a run of all
// sections.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "bench/app/run.h"
#include "bench/sections/run.h"

namespace halfspace::bench {
namespace {

BenchOptions Small() {
  BenchOptions options;
  options.is_quick = true;
  options.objects = 4096;
  options.queries = 8;
  options.repetitions = 1;
  options.command = "--quick";
  return options;
}

const Table* Find(const Report& report, const std::string& name) {
  for (const Table& table : report.tables) {
    if (table.name == name) return &table;
  }
  return nullptr;
}

double ValueOf(const Table& table, std::size_t row, std::size_t column) {
  return table.rows.at(row).at(column).value.value();
}

TEST(SectionsTest, ThePageBeginsWithTheVerdictAndHas100Lines) {
  Progress progress;
  std::ostringstream text;
  const Report report = RunSections(Small(), std::nullopt, progress, &text);
  ASSERT_FALSE(report.tables.empty());
  EXPECT_EQ(report.tables[0].name, "verdict");
  const std::string page = text.str();
  EXPECT_LE(std::count(page.begin(), page.end(), '\n'), 100) << page;
  EXPECT_LT(page.find("verdict: "), page.find("answers: "));
  EXPECT_TRUE(
      page.starts_with("The simplex scan is faster than the box scan "
                       "for objects larger than\n  "))
      << page;
  EXPECT_LT(page.find("With an exact test of "), page.find("cpuinfo-bench "));
  // It draws the verdict.
  ASSERT_TRUE(report.tables[0].chart.has_value());
  EXPECT_EQ(report.tables[0].chart->y.size() + 1,
            report.tables[0].columns.size());
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST(SectionsTest, ARunOfAFileHasOneWorld) {
  BenchOptions options = Small();
  options.details = {"verdict", "quality"};
  options.bounds = "boxes.csv";
  Progress progress;
  const Report report = RunSections(
      options,
      WorkloadOfBoxes("boxes.csv",
                      {{{0, 0, 0}, {1, 1, 1}}, {{2, 2, 2}, {3, 3, 3}}}, 0),
      progress, nullptr);
  const Table& verdict = *Find(report, "verdict");
  EXPECT_EQ(verdict.rows.size(), 1u);
  EXPECT_EQ(verdict.lead.front(),
            "The box scan takes so many times as long as the simplex scan:");
  // The row says what the first lines say.
  EXPECT_NE(verdict.lead[1].find(verdict.rows[0][1].flag == Flag::kWinner
                                     ? ": the simplex is faster"
                                 : verdict.rows[0][1].flag == Flag::kTie
                                     ? ": no difference"
                                     : ": the box is faster"),
            std::string::npos);
  EXPECT_TRUE(verdict.notes[0].starts_with("The file has 2 objects."));
  EXPECT_NE(verdict.notes[1].find("Timed with 2 different queries."),
            std::string::npos)
      << verdict.notes[1];
  EXPECT_EQ(ValueOf(*Find(report, "quality"), 0, 1), 2.0);
}

}  // namespace
}  // namespace halfspace::bench
