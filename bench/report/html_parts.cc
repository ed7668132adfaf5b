#include "bench/report/html_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "bench/report/figures.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kMostText = 600;
constexpr std::size_t kMostRows = 400;
constexpr std::size_t kMostColumns = 24;
constexpr std::size_t kMostSteps = 64;  // of a map, on each axis

std::string Scrolled(const std::string& table) {
  return "<div class=\"scroll\" tabindex=\"0\">" + table + "</div>\n";
}

bool IsListOfObjects(const Json& value) {
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(),
                     [](const Json& element) { return element.is_object(); });
}

// Without lists of objects in its elements.
bool IsTable(const Json& value) {
  return IsListOfObjects(value) &&
         std::none_of(value.begin(), value.end(), [](const Json& row) {
           return std::any_of(row.begin(), row.end(), IsListOfObjects);
         });
}

std::string TableOf(const Json& list) {
  std::vector<std::string> keys;
  std::vector<std::vector<std::string>> rows;
  const std::size_t shown = std::min(list.size(), kMostRows);
  for (std::size_t i = 0; i < shown; ++i) {
    for (const auto& [key, value] : list[i].items()) {
      if (keys.size() < kMostColumns &&
          std::find(keys.begin(), keys.end(), key) == keys.end()) {
        keys.push_back(key);
      }
    }
  }
  rows.push_back(keys);
  for (std::string& key : rows[0])
    std::replace(key.begin(), key.end(), '_', ' ');
  for (std::size_t i = 0; i < shown; ++i) {
    std::vector<std::string> row;
    for (const std::string& key : keys) {
      const auto found = list[i].find(key);
      row.push_back(found == list[i].end() ? "" : ValueText(*found));
    }
    rows.push_back(std::move(row));
  }
  std::string html = HtmlTable(rows);
  if (shown < list.size()) {
    html += Element("p", "and " + std::to_string(list.size() - shown) +
                             " more rows in the JSON report");
  }
  return html;
}

bool AreNumbers(const std::vector<std::vector<std::string>>& rows,
                std::size_t column) {
  return std::all_of(rows.begin() + 1, rows.end(), [column](const auto& row) {
    const std::string& text = row[column];
    return text.empty() || text == "-" ||
           text.find_first_of("0123456789") <= (text[0] == '-' ? 1 : 0);
  });
}

// Values on two axes, each cell with the class that gives its colour.
class Map {
 public:
  void Add(double row, double column, std::string cell) {
    rows_.insert(row);
    columns_.insert(column);
    cells_.emplace(std::pair(row, column), std::move(cell));
  }

  // `corner` names the rows.
  std::string Html(const ReportField& of, const char* corner,
                   const char* above) const {
    if (cells_.empty()) return {};
    if (rows_.size() > kMostSteps || columns_.size() > kMostSteps) {
      of.Fail("has too many steps for a map");
    }
    std::string html = "<table class=\"map\">\n<thead><tr><td></td>";
    html += "<th scope=\"colgroup\" colspan=\"" +
            std::to_string(columns_.size()) + "\">" + above +
            "</th></tr>\n<tr>" + Element("th", corner);
    for (double column : columns_) html += Element("th", Digits(column));
    html += "</tr></thead>\n<tbody>\n";
    for (double row : rows_) {
      html += "<tr><th scope=\"row\">" + Digits(row) + "</th>";
      for (double column : columns_) {
        const auto cell = cells_.find({row, column});
        html += cell == cells_.end() ? "<td></td>" : cell->second;
      }
      html += "</tr>\n";
    }
    return Scrolled(html + "</tbody></table>");
  }

 private:
  std::set<double> rows_;
  std::set<double> columns_;
  std::map<std::pair<double, double>, std::string> cells_;
};

// That of a reader whose objects move, and cannot be sorted: the fastest scan,
// where the winner is none.
std::string BestScan(const ReportField& cell, const std::string& winner) {
  std::string name;
  double least = 0.0;
  for (const ReportField& way : cell.List("ways")) {
    const std::string schedule = way.At("schedule").Text();
    const double ns = way.At("ns_with_exact").Number();
    if (schedule == "sorted" || (!name.empty() && ns >= least)) continue;
    name = way.At("shape").Text() + " " + schedule + " " +
           way.At("precision").Text();
    least = ns;
  }
  if (name.empty() || name == winner) return {};
  return "<br><small>scan: " + Escaped(name) + ", " + Digits(least) +
         " ns</small>";
}

}  // namespace

std::string Escaped(std::string_view text) {
  std::string escaped;
  bool is_cut = text.size() > kMostText;
  if (is_cut) {
    text = text.substr(0, kMostText);
    // Not inside a character.
    while (!text.empty() && (text.back() & 0x80) != 0) text.remove_suffix(1);
  }
  unsigned char before = 0;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_c1 = before == 0xC2 && byte >= 0x80 && byte < 0xA0;
    before = byte;
    if (is_c1) {
      escaped.back() = ' ';
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '\'') {
      escaped += "&#39;";
    } else if (byte < 0x20 || byte == 0x7F) {
      escaped += ' ';
    } else {
      escaped += c;
    }
  }
  return is_cut ? escaped + "..." : escaped;
}

std::string Element(const std::string& name, std::string_view text) {
  return "<" + name + ">" + Escaped(text) + "</" + name + ">\n";
}

std::string HtmlTable(const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table>\n";
  std::vector<bool> are_numbers;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const bool is_head = r == 0;
    if (is_head && rows[r].empty()) {
      html += "<tbody>\n";
      continue;
    }
    html += is_head ? "<thead><tr>" : "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      if (c == are_numbers.size()) are_numbers.push_back(AreNumbers(rows, c));
      const char* tag = is_head || c == 0 ? "th" : "td";
      html += std::string("<") + tag;
      if (is_head) html += " scope=\"col\"";
      if (!is_head && c == 0) html += " scope=\"row\"";
      if (are_numbers[c]) html += " class=\"n\"";
      html += ">" + Escaped(rows[r][c]) + "</" + tag + ">";
    }
    html += is_head ? "</tr></thead>\n<tbody>\n" : "</tr>\n";
  }
  return Scrolled(html + "</tbody></table>");
}

std::string HtmlOf(const Json& value) {
  if (IsTable(value)) return TableOf(value);
  if (!value.is_structured()) return Element("p", ValueText(value));
  std::string html;
  std::size_t left = kMostRows;
  for (const auto& [key, element] : value.items()) {
    if (left-- == 0) break;
    if (value.is_array()) {
      html += HtmlOf(element);
    } else if (IsListOfObjects(element)) {
      html += Element("h4", key) + HtmlOf(element);
    } else {
      html += Element("p", key + ": " + ValueText(element));
    }
  }
  return html;
}

std::string RatioMap(const ReportField& sweep) {
  Map map;
  for (const ReportField& cell : sweep.List("map")) {
    const ReportField ratio = cell.At("simplex_over_aabb");
    const double median = ratio.At("median").Number();
    if (!(median > 0.0)) continue;
    // A step is a tenth more; 1 itself has no colour.
    const double steps = std::log(median) / std::log(1.1);
    const int tint =
        static_cast<int>(std::round(std::clamp(std::abs(steps), 0.0, 5.0)));
    std::string html = "<td class=\"t" + std::to_string(tint) +
                       (median < 1.0 ? " ink2" : " ink3") + "\"";
    if (const auto quartiles = ratio.Find("quartiles")) {
      html +=
          " title=\"quartiles " + Escaped(ValueText(quartiles->json())) + "\"";
    }
    char text[32];
    std::snprintf(text, sizeof(text), "%.2f", std::min(median, 1e6));
    html += std::string(">") + text + "</td>";
    map.Add(cell.At("slab_overlap").Number(), cell.At("w").Number(),
            std::move(html));
  }
  return map.Html(sweep, "overlap of slabs", "w, objects in a batch");
}

std::string FastestTable(const ReportField& sweep) {
  Map map;
  std::vector<std::string> families = {"simplex", "aabb", "aabo"};
  const std::size_t known = families.size();
  for (const ReportField& cell : sweep.List("cells")) {
    const auto size = cell.Find("size");
    if (!size) continue;  // no world of a known size
    const std::string winner = cell.At("winner").Text();
    const std::string family = winner.substr(0, winner.find(' '));
    auto found = std::find(families.begin(), families.end(), family);
    if (found == families.end()) {
      families.push_back(family);
      found = families.end() - 1;
    }
    // Past the three shapes, colours come again after four.
    const std::size_t place = found - families.begin();
    const std::size_t ink =
        2 + (place < known ? place : known + (place - known) % 4);
    const auto is_tie = cell.Find("is_tie");
    map.Add(size->Number() * 100.0, cell.At("objects").Number(),
            "<td class=\"t3 ink" + std::to_string(ink) + "\">" +
                Escaped(winner) + (is_tie && is_tie->Flag() ? " (a tie)" : "") +
                "<br><small>" + Digits(cell.At("ns").Number()) + " ns</small>" +
                BestScan(cell, winner) + "</td>");
  }
  return map.Html(sweep, "size, % of the world", "objects");
}

}  // namespace halfspace::bench
