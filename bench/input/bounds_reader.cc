#include "bench/input/bounds_reader.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "bench/input/text_lines.h"

namespace halfspace::bench {
namespace {

constexpr std::string_view kHeader = "minx,miny,minz,maxx,maxy,maxz";
constexpr std::size_t kFields = 6;

using Fields = std::array<std::string_view, kFields>;

std::string_view Trimmed(std::string_view text) {
  text = SkipBlanks(text);
  while (!text.empty() && IsBlank(text.back())) text.remove_suffix(1);
  return text;
}

Fields Split(std::string_view row) {
  Fields fields;
  for (std::string_view& field : fields) {
    const std::size_t comma = row.find(',');
    field = Trimmed(row.substr(0, comma));
    row.remove_prefix(comma == std::string_view::npos ? row.size() : comma + 1);
  }
  return fields;
}

void CheckFieldCount(const TextLines& lines, std::string_view row) {
  const auto count =
      static_cast<std::size_t>(std::count(row.begin(), row.end(), ',')) + 1;
  if (count == kFields) return;
  lines.Fail("expected 6 fields with commas between them, found " +
                 std::to_string(count) + " in " + Quoted(row),
             "write " + std::string(kHeader));
}

void CheckOrder(const TextLines& lines, const Aabb3& box,
                const Fields& fields) {
  constexpr std::array<char, 3> kAxes = {'x', 'y', 'z'};
  for (std::size_t k = 0; k < kAxes.size(); ++k) {
    if (box.min[k] <= box.max[k]) continue;
    lines.Fail(std::string("min") + kAxes[k] + " " + Quoted(fields[k]) +
                   " is above max" + kAxes[k] + " " + Quoted(fields[k + 3]),
               "write the smaller one first");
  }
}

Aabb3 ParseRow(const TextLines& lines, std::string_view row) {
  CheckFieldCount(lines, row);
  const Fields fields = Split(row);
  std::array<float, kFields> v;
  for (std::size_t k = 0; k < kFields; ++k) v[k] = ParseFloat(lines, fields[k]);
  const Aabb3 box = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  CheckOrder(lines, box, fields);
  return box;
}

void CheckLength(const TextLines& lines, std::string_view line) {
  constexpr std::size_t kLongest = 4096;
  if (line.size() <= kLongest) return;
  lines.Fail("the line is " + std::to_string(line.size()) +
                 " characters long, expected at most " +
                 std::to_string(kLongest),
             "write one box a line");
}

}  // namespace

std::vector<Aabb3> ReadBounds(const std::string& path) {
  TextLines lines(path, ReadText(path));
  std::vector<Aabb3> boxes;
  bool is_first_row = true;
  while (const std::optional<std::string_view> line = lines.Next()) {
    CheckLength(lines, *line);
    const std::string_view row = Trimmed(*line);
    if (row.empty() || row.starts_with('#')) continue;
    if (!is_first_row || row != kHeader) {
      boxes.push_back(ParseRow(lines, row));
    }
    is_first_row = false;
  }
  if (boxes.empty()) {
    lines.Fail("the file ends without a box",
               "write one box a line, as " + std::string(kHeader));
  }
  return boxes;
}

}  // namespace halfspace::bench
