#include "bench/input/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <system_error>
#include <utility>

#include "bench/input/input_file.h"

namespace halfspace::bench {
namespace {

// from_chars does not tell a number that is too large from one that is too
// small; strtof does, and the nearest float to the latter is a zero or the
// smallest float. The program never leaves the "C" locale.
float BeyondRange(const char* begin, const char* end) {
  return std::strtof(std::string(begin, end).c_str(), nullptr);
}

}  // namespace

TextLines::TextLines(std::string path, std::string text)
    : path_(std::move(path)), text_(std::move(text)), rest_(text_) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.starts_with(kByteOrderMark)) {
    rest_.remove_prefix(kByteOrderMark.size());
  }
  if (rest_.empty()) {
    FailAt(1, "the file is empty", "give a file with content");
  }
}

std::optional<std::string_view> TextLines::Next() {
  if (rest_.empty()) return std::nullopt;
  const std::string_view line = rest_.substr(0, rest_.find_first_of("\r\n"));
  rest_.remove_prefix(line.size());
  const std::size_t end = rest_.starts_with("\r\n") ? 2 : 1;
  rest_.remove_prefix(std::min(end, rest_.size()));
  ++number_;
  return line;
}

void TextLines::Fail(const std::string& problem,
                     const std::string& advice) const {
  FailAt(number_, problem, advice);
}

void TextLines::FailAt(std::size_t line, const std::string& problem,
                       const std::string& advice) const {
  throw InputError(path_, line, problem, advice);
}

std::string_view SkipBlanks(std::string_view text) {
  while (!text.empty() && IsBlank(text.front())) text.remove_prefix(1);
  return text;
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kMost = 32;
  std::string quoted = "\"";
  for (char c : text.substr(0, kMost)) {
    if (c >= ' ' && c <= '~') {
      quoted += c;
    } else {
      constexpr std::string_view kDigits = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(c);
      quoted.append("\\x").append(1, kDigits[byte / 16]);
      quoted.append(1, kDigits[byte % 16]);
    }
  }
  return quoted.append(text.size() > kMost ? "...\"" : "\"");
}

float ParseFloat(const TextLines& lines, std::string_view field) {
  constexpr const char* kAdvice = "write a number such as 1.5 or -2e3";
  // from_chars knows no plus, and would take the minus of "+-1".
  const bool plus = field.starts_with('+') && !field.starts_with("+-");
  const char* begin = field.data() + (plus ? 1 : 0);
  const char* end = field.data() + field.size();
  float value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (error == std::errc::invalid_argument || stop != end) {
    lines.Fail(Quoted(field) + " is not a number", kAdvice);
  }
  if (error == std::errc::result_out_of_range) {
    value = BeyondRange(begin, end);
    if (std::isinf(value)) {
      lines.Fail(Quoted(field) + " is too large for a 32-bit float",
                 "scale the coordinates down");
    }
  }
  if (!std::isfinite(value)) {
    lines.Fail(Quoted(field) + " is not a finite number", kAdvice);
  }
  return value;
}

}  // namespace halfspace::bench
