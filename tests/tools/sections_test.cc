// One small run of every section.
#include "bench/sections/sections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "bench/app/run.h"

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

TEST(SectionsTest, AllHaveWellFormedTables) {
  BenchOptions options = Small();
  options.details = {"all"};
  Progress progress;
  std::ostringstream text;
  const Report report = RunSections(options, std::nullopt, progress, &text);
  std::set<std::string> names;
  for (const Table& table : report.tables) {
    EXPECT_TRUE(names.insert(table.name).second) << table.name;
    const std::string section = table.name.substr(0, table.name.find(':'));
    EXPECT_TRUE(std::any_of(
        Sections().begin(), Sections().end(),
        [&section](const Section& each) { return each.name == section; }))
        << table.name;
    if (table.is_empty()) continue;
    EXPECT_NE(text.str().find("\n" + table.name + ": "), std::string::npos);
    std::set<std::string> keys;
    for (const Row& row : table.rows) {
      ASSERT_EQ(row.size(), table.columns.size()) << table.name;
      std::string key;
      for (std::size_t c = 0; c < row.size(); ++c) {
        if (!table.columns[c].is_key) continue;
        key += row[c].text +
               (row[c].value ? std::to_string(*row[c].value) : "") + "|";
      }
      EXPECT_TRUE(keys.insert(key).second) << table.name << ": " << key;
    }
    if (!table.chart) continue;
    std::vector<std::string> charted = table.chart->y;
    charted.push_back(table.chart->x);
    for (const std::string& name : charted) {
      EXPECT_TRUE(std::any_of(
          table.columns.begin(), table.columns.end(),
          [&name](const Column& column) { return column.name == name; }))
          << table.name << ": " << name;
    }
  }
  for (const Section& section : Sections()) {
    EXPECT_NE(Find(report, std::string(section.name)), nullptr) << section.name;
  }
  EXPECT_EQ(report.ValueOf("scope"), "--quick --objects 4096 --queries 8");

  // Counts are the same on every machine.
  const Table& table1 = *Find(report, "table1");
  EXPECT_NEAR(ValueOf(table1, 6, 3), 4.0, 0.1);
  const Table& early_out = *Find(report, "model: early-out");
  ASSERT_EQ(early_out.rows.size(), 7u);
  EXPECT_NEAR(ValueOf(early_out, 0, 1), ValueOf(early_out, 0, 3), 1e-9);
  EXPECT_GT(ValueOf(early_out, 1, 3), ValueOf(early_out, 1, 1));
  const Table& cube = *Find(report, "model: cube");
  EXPECT_NEAR(ValueOf(cube, 0, 1), ValueOf(cube, 0, 2), 0.2);
  EXPECT_NEAR(ValueOf(cube, 1, 1), ValueOf(cube, 1, 2), 0.1);
  // Batches of objects that are sorted stop earlier.
  const Table& sorted = *Find(report, "table1: sorted objects");
  for (std::size_t row = 1; row < 4; ++row) {
    EXPECT_LT(ValueOf(sorted, row, 1), 0.8 * ValueOf(sorted, 0, 1));
  }
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
