#include "bench/base/text.h"

#include <cstdio>

namespace halfspace::bench {

std::string Fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

std::string Fixed(const std::optional<double>& value, int digits) {
  return value ? Fixed(*value, digits) : "-";
}

std::string Grouped(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t at = digits.size(); at > 3; at -= 3) {
    digits.insert(at - 3, 1, ' ');
  }
  return digits;
}

std::string Printable(std::string_view text) {
  std::string printable;
  unsigned char before = 0;
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    // U+0080 to U+009F are control characters, too.
    const bool is_c1 = before == 0xC2 && byte >= 0x80 && byte < 0xA0;
    if (byte < 0x20 || byte == 0x7F || is_c1) {
      char escaped[8];
      std::snprintf(escaped, sizeof(escaped), "\\x%02x", byte);
      printable += escaped;
    } else {
      printable += c;
    }
    before = byte;
  }
  return printable;
}

std::string NameOf(Target target) {
  const std::string_view name = target.name();
  if (name.starts_with("AVX3")) return "AVX-512";
  if (name == "SSE4") return "SSE4.2";
  if (name == "SCALAR") return "scalar";
  return std::string(name);
}

std::string Mebibytes(std::uintmax_t bytes) {
  constexpr std::uintmax_t kMebibyte = std::uintmax_t{1} << 20;
  return std::to_string(bytes / kMebibyte + (bytes % kMebibyte != 0)) + " MiB";
}

}  // namespace halfspace::bench
