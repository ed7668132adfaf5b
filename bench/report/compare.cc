#include <algorithm>
#include <cmath>

#include "bench/base/text.h"
#include "bench/report/table.h"

namespace halfspace::bench {
namespace {

constexpr double kTolerance = 0.1;

// The keys of a row, in one line.
std::string NameOf(const Table& table, const Row& row) {
  std::string name = table.name;
  for (std::size_t c = 0; c < row.size(); ++c) {
    if (!table.columns[c].is_key) continue;
    name += ", " + (row[c].value ? Fixed(*row[c].value, 6) : row[c].text);
  }
  return name;
}

const Table* TableOf(const Report& report, const std::string& name) {
  for (const Table& table : report.tables) {
    if (table.name == name) return &table;
  }
  return nullptr;
}

// Of two numbers, without a spread both its ends.
std::pair<double, double> EndsOf(const Cell& cell) {
  return cell.spread.value_or(std::pair(*cell.value, *cell.value));
}

bool IsWorse(const Cell& stored, const Cell& now, Better better) {
  const auto [stored_low, stored_high] = EndsOf(stored);
  const auto [low, high] = EndsOf(now);
  return better == Better::kHigher
             ? *now.value < *stored.value * (1.0 - kTolerance) &&
                   high < stored_low
             : *now.value > *stored.value * (1.0 + kTolerance) &&
                   low > stored_high;
}

void CompareRows(const Table& table, const Row& now, const Table& old,
                 const Row& stored, Comparison& result) {
  for (std::size_t c = 0; c < now.size(); ++c) {
    const Column& column = table.columns[c];
    if (column.better == Better::kNeither || !now[c].value) continue;
    for (std::size_t s = 0; s < stored.size(); ++s) {
      if (old.columns[s].name != column.name || !stored[s].value) continue;
      ++result.compared;
      if (!IsWorse(stored[s], now[c], column.better)) continue;
      result.worse.push_back(NameOf(table, now) + ": " + column.name + " " +
                             Fixed(*now[c].value, column.digits) + ", was " +
                             Fixed(*stored[s].value, column.digits));
      if (result.tables.empty() || result.tables.back() != table.name) {
        result.tables.push_back(table.name);
      }
    }
  }
}

}  // namespace

Comparison Compare(const Report& stored, const Report& now) {
  Comparison result;
  for (const Table& table : now.tables) {
    const Table* old = TableOf(stored, table.name);
    if (old == nullptr) continue;
    for (const Row& row : table.rows) {
      const auto same = std::find_if(
          old->rows.begin(), old->rows.end(),
          [&](const Row& r) { return NameOf(*old, r) == NameOf(table, row); });
      if (same != old->rows.end()) {
        CompareRows(table, row, *old, *same, result);
      }
    }
  }
  return result;
}

}  // namespace halfspace::bench
