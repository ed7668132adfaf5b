#include "bench/input/text_lines.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <system_error>
#include <utility>

#include "bench/base/text.h"

namespace halfspace::bench {
namespace {

[[noreturn]] void FailToRead(const std::string& path, int error) {
  throw InputError(path,
                   "cannot be read: " + std::generic_category().message(error),
                   "give the path of a readable file");
}

[[noreturn]] void FailOnNul(const std::string& path, std::string_view text,
                            std::size_t nul) {
  // As TextLines counts.
  std::size_t line = 1;
  for (std::size_t i = 0; i < nul; ++i) {
    line += text[i] == '\n' || (text[i] == '\r' && text[i + 1] != '\n');
  }
  throw InputError(path, line, "a NUL byte, so this is no text file",
                   "give a plain text file");
}

}  // namespace

std::string ReadText(const std::string& path) {
  constexpr std::size_t kChunk = std::size_t{1} << 16;
  std::ifstream file(path, std::ios::binary);
  std::string text;
  while (file) {
    const std::size_t size = text.size();
    text.resize(size + kChunk);
    file.read(&text[size], kChunk);
    text.resize(size + static_cast<std::size_t>(file.gcount()));
    const std::size_t nul = text.find('\0', size);
    if (nul != std::string::npos) FailOnNul(path, text, nul);
  }
  if (!file.eof()) FailToRead(path, errno);
  return text;
}

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
