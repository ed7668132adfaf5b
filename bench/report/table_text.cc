#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/base/text.h"
#include "bench/report/table.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kTableWidth = 100;
constexpr std::size_t kNoteWidth = 98;

std::string TextOf(double value, int digits) {
  const bool is_grouped = digits == 0 && value >= 0.0 && value < 0x1p53;
  return is_grouped ? Grouped(static_cast<std::size_t>(std::llround(value)))
                    : Fixed(value, digits);
}

std::string TextOf(const Cell& cell, int digits) {
  std::string text = Printable(cell.text);
  if (cell.value) {
    text = TextOf(*cell.value, digits);
    if (cell.spread) {
      text += " [" + TextOf(cell.spread->first, digits) + ", " +
              TextOf(cell.spread->second, digits) + "]";
    }
  } else if (text.empty()) {
    text = "-";
  }
  switch (cell.flag) {
    case Flag::kNone:
      return text;
    case Flag::kMet:
      return text + " met";
    case Flag::kMissed:
      return text + " MISSED";
    case Flag::kWinner:
      return text + " *";
    case Flag::kTie:
      return text + " =";
  }
  return text;
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

// A row of text, whose cells wrap at the widths of their columns.
void WriteLine(std::ostream& out, const std::vector<std::string>& cells,
               const std::vector<std::size_t>& widths,
               const std::vector<bool>& is_text) {
  std::vector<std::vector<std::string>> parts;
  std::size_t height = 1;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    parts.push_back(cells[c].size() > widths[c]
                        ? Wrapped(cells[c], widths[c])
                        : std::vector<std::string>{cells[c]});
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

// Narrows the widest column of text until the table fits.
void Narrow(std::vector<std::size_t>& widths,
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
    if (widest == widths.size()) return;
    --widths[widest];
    --total;
  }
}

}  // namespace

void WriteText(std::ostream& out, const Table& table) {
  if (table.is_empty()) return;
  out << '\n';
  for (const std::string& line :
       Wrapped(table.name + ": " + table.title, kTableWidth)) {
    out << line << '\n';
  }
  out << '\n';
  std::vector<std::vector<std::string>> lines;
  std::vector<bool> is_text(table.columns.size(), true);
  if (!table.rows.empty()) {
    lines.emplace_back();
    for (const Column& column : table.columns) {
      lines.back().push_back(column.name +
                             (column.unit.empty() ? "" : ", " + column.unit));
    }
  }
  for (const Row& row : table.rows) {
    lines.emplace_back();
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (row[c].value) is_text[c] = false;
      lines.back().push_back(TextOf(row[c], table.columns[c].digits));
    }
  }
  std::vector<std::size_t> widths(table.columns.size());
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < line.size(); ++c) {
      widths[c] = std::max(widths[c], line[c].size());
    }
  }
  Narrow(widths, is_text);
  for (const auto& line : lines) WriteLine(out, line, widths, is_text);
  if (!lines.empty() && !table.notes.empty()) out << '\n';
  for (const std::string& note : table.notes) {
    for (const std::string& line : Wrapped(Printable(note), kNoteWidth)) {
      out << "  " << line << '\n';
    }
  }
}

}  // namespace halfspace::bench
