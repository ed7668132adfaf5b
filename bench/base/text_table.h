// A table of text with aligned columns.
#ifndef HALFSPACE_BENCH_BASE_TEXT_TABLE_H_
#define HALFSPACE_BENCH_BASE_TEXT_TABLE_H_

#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace halfspace::bench {

class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);

  void AddRow(std::vector<std::string> cells);

  // The first `left_columns` columns are aligned to the left, the numbers after
  // them to the right.
  void Write(std::ostream& out, std::size_t left_columns) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// With that many digits after the point; "-" for nothing.
std::string Fixed(double value, int digits);
std::string Fixed(const std::optional<double>& value, int digits);

// 65536 as "65 536".
std::string Grouped(std::size_t value);

// What a file name or a variable holds, safe for a terminal: control characters
// as \xNN.
std::string Printable(std::string_view text);

// "12 MiB", rounded up.
std::string Mebibytes(std::size_t bytes);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_TEXT_TABLE_H_
