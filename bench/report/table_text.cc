#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/base/text.h"
#include "bench/report/table.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kTableWidth = 80;
constexpr std::size_t kNoteWidth = 78;

std::string TextOf(double value, int digits) {
  const bool is_grouped = digits == 0 && value >= 0.0 && value < 0x1p53;
  return is_grouped ? Grouped(static_cast<std::size_t>(std::llround(value)))
                    : Fixed(value, digits);
}

// The lines of a cell: one, or two if the range has its own.
std::vector<std::string> LinesOf(const Cell& cell, int digits,
                                 bool has_range_below) {
  constexpr const char* kMarks[] = {"", " *", " ="};
  const std::string mark = kMarks[static_cast<std::size_t>(cell.flag)];
  if (!cell.value) {
    return {(cell.text.empty() ? "-" : Printable(cell.text)) + mark};
  }
  const std::string value = TextOf(*cell.value, digits);
  if (!cell.spread) return {value + mark};
  const std::string range = "[" + TextOf(cell.spread->first, digits) + ", " +
                            TextOf(cell.spread->second, digits) + "]";
  if (has_range_below) return {value + mark, range};
  return {value + " " + range + mark};
}

// Words in lines of that width; a longer word has a line of its own.
std::vector<std::string> Wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.back().empty() &&
        lines.back().size() + 1 + word.size() > width) {
      lines.emplace_back();
    }
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

// The lines of each cell of a row.
using RowLines = std::vector<std::vector<std::string>>;

// A row of text, whose cells wrap at the widths of their columns.
void WriteRow(std::ostream& out, const RowLines& cells,
              const std::vector<std::size_t>& widths,
              const std::vector<bool>& is_text) {
  RowLines parts;
  std::size_t height = 1;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    parts.push_back(cells[c].size() == 1 && cells[c][0].size() > widths[c]
                        ? Wrapped(cells[c][0], widths[c])
                        : cells[c]);
    height = std::max(height, parts.back().size());
  }
  for (std::size_t l = 0; l < height; ++l) {
    std::string line;
    for (std::size_t c = 0; c < parts.size(); ++c) {
      const std::string text = l < parts[c].size() ? parts[c][l] : "";
      const std::string pad(widths[c] - std::min(widths[c], text.size()), ' ');
      line += "  " + (is_text[c] ? text + pad : pad + text);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
}

// Narrows the widest column of text until the table fits. False if it does not.
bool Narrow(std::vector<std::size_t>& widths,
            const std::vector<bool>& is_text) {
  constexpr std::size_t kLeast = 16;
  std::size_t total = 0;
  for (std::size_t width : widths) total += width + 2;
  while (total > kTableWidth) {
    std::size_t widest = widths.size();
    for (std::size_t c = 0; c < widths.size(); ++c) {
      if (is_text[c] && widths[c] > kLeast &&
          (widest == widths.size() || widths[c] > widths[widest])) {
        widest = c;
      }
    }
    if (widest == widths.size()) return false;
    --widths[widest];
    --total;
  }
  return true;
}

void WriteRows(std::ostream& out, const Table& table) {
  if (table.rows.empty()) return;
  std::vector<bool> is_text(table.columns.size(), true);
  for (const Row& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (row[c].value) is_text[c] = false;
    }
  }
  // If a table is too wide, the names of its columns wrap, and then each range
  // has a line of its own.
  enum { kWhole, kNamesWrap, kRangesBelow };
  for (int how : {kWhole, kNamesWrap, kRangesBelow}) {
    std::vector<RowLines> lines(1);
    std::vector<std::size_t> widths;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const Column& column = table.columns[c];
      const std::string name =
          column.name + (column.unit.empty() ? "" : ", " + column.unit);
      lines[0].push_back({name});
      const bool is_whole = how == kWhole || is_text[c];
      widths.push_back(0);
      for (const std::string& word :
           Wrapped(name, is_whole ? name.size() : 1)) {
        widths[c] = std::max(widths[c], word.size());
      }
    }
    for (const Row& row : table.rows) {
      lines.emplace_back();
      for (std::size_t c = 0; c < row.size(); ++c) {
        lines.back().push_back(
            LinesOf(row[c], table.columns[c].digits, how == kRangesBelow));
        for (const std::string& line : lines.back()[c]) {
          widths[c] = std::max(widths[c], line.size());
        }
      }
    }
    if (!Narrow(widths, is_text) && how != kRangesBelow) continue;
    for (const RowLines& row : lines) WriteRow(out, row, widths, is_text);
    return;
  }
}

}  // namespace

void WriteLead(std::ostream& out, const Table& table) {
  for (const std::string& each : table.lead) {
    const std::string text = Printable(each);
    if (text.size() <= kTableWidth) {
      out << text << '\n';
      continue;
    }
    for (const std::string& line : Wrapped(text, kTableWidth)) {
      out << line << '\n';
    }
  }
}

void WriteText(std::ostream& out, const Table& table) {
  if (table.is_empty()) return;
  out << '\n';
  for (const std::string& line :
       Wrapped(table.name + ": " + table.title, kTableWidth)) {
    out << line << '\n';
  }
  out << '\n';
  WriteRows(out, table);
  if (!table.rows.empty() && !table.notes.empty()) out << '\n';
  for (const std::string& note : table.notes) {
    for (const std::string& line : Wrapped(Printable(note), kNoteWidth)) {
      out << "  " << line << '\n';
    }
  }
}

}  // namespace halfspace::bench
