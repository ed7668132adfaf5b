// A report: what was measured on which machine, as tables. Sections fill them,
// and the writers know nothing else.
#ifndef HALFSPACE_BENCH_REPORT_TABLE_H_
#define HALFSPACE_BENCH_REPORT_TABLE_H_

#include <cstddef>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/measure/measure.h"

namespace halfspace::bench {

enum class Better { kNeither, kLower, kHigher };

struct Column {
  std::string name;
  std::string unit = {};
  bool is_key = false;  // with the other keys, it identifies a row
  // Two runs can be compared by a column that has a better side.
  Better better = Better::kNeither;
  int digits = 2;  // after the point, in text
};

// A column that identifies rows, and one of numbers that are not compared.
inline Column Key(std::string name, std::string unit = {}) {
  return {std::move(name), std::move(unit), true, Better::kNeither, 0};
}
inline Column Value(std::string name, std::string unit = {}, int digits = 2) {
  return {std::move(name), std::move(unit), false, Better::kNeither, digits};
}
// Values that are compared.
inline Column Lower(std::string name, std::string unit = {}, int digits = 2) {
  return {std::move(name), std::move(unit), false, Better::kLower, digits};
}
inline Column Higher(std::string name, std::string unit = {}, int digits = 2) {
  return {std::move(name), std::move(unit), false, Better::kHigher, digits};
}

enum class Flag { kNone, kWinner, kTie };

// A text, a number, or nothing: then the value was not measured. A number may
// have a spread.
struct Cell {
  Cell() = default;
  // NOLINTBEGIN(google-explicit-constructor): rows are lists of cells.
  Cell(std::string words) : text(std::move(words)) {}
  Cell(const char* words) : text(words) {}
  Cell(double number) : value(number) {}
  Cell(std::size_t count) : value(static_cast<double>(count)) {}
  Cell(const std::optional<double>& number) : value(number) {}
  Cell(const Ratio& r) : value(r.median), spread(std::pair(r.low, r.high)) {}
  // NOLINTEND(google-explicit-constructor)

  Cell With(Flag other) const {
    Cell cell = *this;
    cell.flag = other;
    return cell;
  }

  std::string text;
  std::optional<double> value;
  std::optional<std::pair<double, double>> spread = {};
  Flag flag = Flag::kNone;

  bool operator==(const Cell&) const = default;
};

// Columns by name.
struct Chart {
  std::string x;
  std::vector<std::string> y;
  std::string series =
      {};  // one line for each of its values; empty: for each y
  bool is_x_log = false;
  bool is_y_log = false;
  // Places to mark on a line: the name of the line, and x.
  std::vector<std::pair<std::string, double>> marks = {};
};

using Row = std::vector<Cell>;

struct Table {
  std::string name;  // unique in a report: the section's, or "section: part"
  std::string title;
  std::vector<Column> columns = {};
  std::vector<Row> rows = {};
  std::vector<std::string> notes = {};
  std::optional<Chart> chart = {};
  // Lines before the title, written as they are. On the page they come first.
  std::vector<std::string> lead = {};

  void Add(Row row) { rows.push_back(std::move(row)); }
  // A table with notes alone is left out, unless it has notes.
  bool is_empty() const { return rows.empty() && notes.empty(); }
};

using Tables = std::vector<Table>;

// "machine", "build", ... in the order of the report.
using Context = std::vector<std::pair<std::string, std::string>>;

struct Report {
  Context context;
  Tables tables;

  std::string ValueOf(std::string_view name) const;
};

// A table in aligned columns, at most 80 wide if its texts allow, and its
// notes. A range has a line of its own if the table would be wider.
void WriteText(std::ostream& out, const Table& table);

// The lines that come before everything else.
void WriteLead(std::ostream& out, const Table& table);

// docs/report.schema.json describes it.
std::string ToJson(const Report& report);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_REPORT_TABLE_H_
