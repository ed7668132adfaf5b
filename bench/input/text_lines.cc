#include "bench/input/text_lines.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/base/text.h"
#include "bench/input/input_file.h"

namespace halfspace::bench {
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
  const bool plus = field.starts_with('+') && !field.starts_with("+-");
  const std::optional<float> value =
      ParseNumber<float>(field.substr(plus ? 1 : 0));
  if (!value) lines.Fail(Quoted(field) + " is not a number", kAdvice);
  if (std::isinf(*value) &&
      field.find_first_of("0123456789") != std::string_view::npos) {
    lines.Fail(Quoted(field) + " is too large for a 32-bit float",
               "scale the coordinates down");
  }
  if (!std::isfinite(*value)) {
    lines.Fail(Quoted(field) + " is not a finite number", kAdvice);
  }
  return *value;
}

}  // namespace halfspace::bench
