#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "bench/report/table.h"

namespace halfspace::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kSchema = 4;
constexpr std::array<const char*, 3> kBetter = {"", "lower", "higher"};
constexpr std::array<const char*, 3> kFlags = {"", "winner", "tie"};

// Whole numbers are counts, and exact; others keep five digits.
Json ToJson(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == std::floor(value) && std::abs(value) < 0x1p53) {
    return static_cast<std::int64_t>(value);
  }
  char text[32];
  std::snprintf(text, sizeof(text), "%.5g", value);
  return std::strtod(text, nullptr);
}

// A text, a number, null, or a list: value, low, high and flag.
Json ToJson(const Cell& cell) {
  Json json = cell.value          ? ToJson(*cell.value)
              : cell.text.empty() ? Json(nullptr)
                                  : Json(cell.text);
  if (!cell.spread && cell.flag == Flag::kNone) return json;
  Json list = Json::array({json, nullptr, nullptr});
  if (cell.spread) {
    list[1] = ToJson(cell.spread->first);
    list[2] = ToJson(cell.spread->second);
  }
  if (cell.flag != Flag::kNone) {
    list.push_back(kFlags[static_cast<std::size_t>(cell.flag)]);
  }
  return list;
}

Json ToJson(const Table& table) {
  Json json = {{"name", table.name}, {"title", table.title}};
  Json& columns = json["columns"] = Json::array();
  for (const Column& column : table.columns) {
    Json each = {{"name", column.name}};
    if (!column.unit.empty()) each["unit"] = column.unit;
    if (column.is_key) each["key"] = true;
    if (column.better != Better::kNeither) {
      each["better"] = kBetter[static_cast<std::size_t>(column.better)];
    }
    each["digits"] = column.digits;
    columns.push_back(each);
  }
  Json& rows = json["rows"] = Json::array();
  for (const Row& row : table.rows) {
    Json cells = Json::array();
    for (const Cell& cell : row) cells.push_back(ToJson(cell));
    rows.push_back(cells);
  }
  if (!table.notes.empty()) json["notes"] = table.notes;
  if (table.chart) {
    json["chart"] = {{"x", table.chart->x},
                     {"y", table.chart->y},
                     {"series", table.chart->series},
                     {"x_log", table.chart->is_x_log},
                     {"y_log", table.chart->is_y_log}};
    if (!table.chart->marks.empty()) {
      Json& marks = json["chart"]["marks"] = Json::array();
      for (const auto& [line, x] : table.chart->marks) {
        marks.push_back(Json::array({line, ToJson(x)}));
      }
    }
  }
  if (!table.lead.empty()) json["lead"] = table.lead;
  return json;
}

// A line for each row, so that versions of a stored run can be compared.
void AppendLines(std::string& text, const Json& table) {
  const auto dump = [](const Json& json) {
    // A file name in another encoding must not stop the report.
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  Json rest = table;
  rest.erase("rows");
  std::string head = dump(rest);
  head.pop_back();
  text += head + ",\"rows\":[";
  const char* before = "\n";
  for (const Json& row : table.at("rows")) {
    text += before + dump(row);
    before = ",\n";
  }
  text += "]}";
}

}  // namespace

std::string Report::ValueOf(std::string_view name) const {
  for (const auto& [key, value] : context) {
    if (key == name) return value;
  }
  return {};
}

std::string ToJson(const Report& report) {
  Json context = Json::object();
  for (const auto& [key, value] : report.context) context[key] = value;
  std::string text =
      "{\"schema\":" + std::to_string(kSchema) + ",\n\"context\":" +
      context.dump(1, ' ', false, Json::error_handler_t::replace) +
      ",\n\"tables\":[";
  const char* before = "\n";
  for (const Table& table : report.tables) {
    if (table.is_empty()) continue;
    text += before;
    AppendLines(text, ToJson(table));
    before = ",\n";
  }
  return text + "]}\n";
}

}  // namespace halfspace::bench
