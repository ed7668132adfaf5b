#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "bench/report/table.h"

namespace halfspace::bench {
namespace {

constexpr int kSchema = 4;
constexpr std::array<const char*, 3> kBetter = {"", "lower", "higher"};
constexpr std::array<const char*, 3> kFlags = {"", "winner", "tie"};

// The bytes of the UTF-8 character that a text begins with; 0 if there is none.
std::size_t BytesOfCharacter(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return 1;
  const std::size_t bytes = lead < 0xC0   ? 0
                            : lead < 0xE0 ? 2
                            : lead < 0xF0 ? 3
                                          : 4;
  if (bytes == 0 || bytes > text.size()) return 0;
  std::uint32_t code = lead & (0x7Fu >> bytes);
  for (char next : text.substr(1, bytes - 1)) {
    if ((next & 0xC0) != 0x80) return 0;
    code = code << 6 | (next & 0x3F);
  }
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >> 11 == 0x1B;
  return code < kLeast[bytes] || code > 0x10FFFF || is_surrogate ? 0 : bytes;
}

// A file name in another encoding must not stop the report: other bytes become
// U+FFFD.
std::string ToJson(const std::string& text) {
  std::string json = "\"";
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t bytes =
        BytesOfCharacter(std::string_view(text).substr(i));
    const char c = text[i];
    if (bytes == 0) {
      json += "\xEF\xBF\xBD";
    } else if (c == '"' || c == '\\') {
      json.append(1, '\\').append(1, c);
    } else if (c == '\n') {
      json += "\\n";
    } else if (bytes == 1 && c < ' ') {
      char escaped[8];
      std::snprintf(escaped, sizeof(escaped), "\\u%04x", c);
      json += escaped;
    } else {
      json.append(text, i, bytes);
    }
    i += bytes == 0 ? 1 : bytes;
  }
  return json + "\"";
}

// Whole numbers are counts, and exact; others keep five digits.
std::string ToJson(double value) {
  if (!std::isfinite(value)) return "null";
  const bool is_count = value == std::floor(value) && std::abs(value) < 0x1p53;
  char text[32];
  std::snprintf(text, sizeof(text), is_count ? "%.0f" : "%.5g",
                is_count ? value + 0.0 : value);
  return text;
}

std::string ToJson(bool value) { return value ? "true" : "false"; }

template <typename List, typename Json>
std::string ListOf(const List& list, Json json) {
  std::string text;
  for (const auto& each : list) text += (text.empty() ? "" : ",") + json(each);
  return "[" + text + "]";
}
std::string ListOf(const std::vector<std::string>& texts) {
  return ListOf(texts, [](const std::string& text) { return ToJson(text); });
}

// A text, a number, null, or a list: value, low, high and flag.
std::string ToJson(const Cell& cell) {
  std::string json = cell.value          ? ToJson(*cell.value)
                     : cell.text.empty() ? "null"
                                         : ToJson(cell.text);
  if (!cell.spread && cell.flag == Flag::kNone) return json;
  json = "[" + json + "," +
         (cell.spread
              ? ToJson(cell.spread->first) + "," + ToJson(cell.spread->second)
              : "null,null");
  if (cell.flag != Flag::kNone) {
    json +=
        ",\"" + std::string(kFlags[static_cast<std::size_t>(cell.flag)]) + "\"";
  }
  return json + "]";
}

std::string ToJson(const Column& column) {
  std::string json = "{\"name\":" + ToJson(column.name);
  if (!column.unit.empty()) json += ",\"unit\":" + ToJson(column.unit);
  if (column.is_key) json += ",\"key\":true";
  if (column.better != Better::kNeither) {
    json += ",\"better\":\"" +
            std::string(kBetter[static_cast<std::size_t>(column.better)]) +
            "\"";
  }
  return json + ",\"digits\":" + std::to_string(column.digits) + "}";
}

std::string ToJson(const Chart& chart) {
  std::string json = "{\"x\":" + ToJson(chart.x) + ",\"y\":" + ListOf(chart.y) +
                     ",\"series\":" + ToJson(chart.series) +
                     ",\"x_log\":" + ToJson(chart.is_x_log) +
                     ",\"y_log\":" + ToJson(chart.is_y_log);
  if (!chart.marks.empty()) {
    json += ",\"marks\":" + ListOf(chart.marks, [](const auto& mark) {
              return "[" + ToJson(mark.first) + "," + ToJson(mark.second) + "]";
            });
  }
  return json + "}";
}

// A line for each row, so that versions of a stored run can be compared.
std::string ToJson(const Table& table) {
  std::string json =
      "{\"name\":" + ToJson(table.name) + ",\"title\":" + ToJson(table.title) +
      ",\"columns\":" +
      ListOf(table.columns, [](const Column& each) { return ToJson(each); });
  if (!table.notes.empty()) json += ",\"notes\":" + ListOf(table.notes);
  if (table.chart) json += ",\"chart\":" + ToJson(*table.chart);
  if (!table.lead.empty()) json += ",\"lead\":" + ListOf(table.lead);
  return json + ",\"rows\":" +
         ListOf(table.rows,
                [](const Row& row) {
                  return "\n" + ListOf(row, [](const Cell& cell) {
                           return ToJson(cell);
                         });
                }) +
         "}";
}

}  // namespace

std::string Report::ValueOf(std::string_view name) const {
  for (const auto& [key, value] : context) {
    if (key == name) return value;
  }
  return {};
}

std::string ToJson(const Report& report) {
  std::string text =
      "{\"schema\":" + std::to_string(kSchema) + ",\n\"context\":{";
  const char* before = "\n ";
  for (const auto& [key, value] : report.context) {
    text += before + ToJson(key) + ": " + ToJson(value);
    before = ",\n ";
  }
  text += "\n},\n\"tables\":[";
  before = "\n";
  for (const Table& table : report.tables) {
    if (table.is_empty()) continue;
    text += before + ToJson(table);
    before = ",\n";
  }
  return text + "]}\n";
}

}  // namespace halfspace::bench
