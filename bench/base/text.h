// Numbers and names as text.
#ifndef HALFSPACE_BENCH_BASE_TEXT_H_
#define HALFSPACE_BENCH_BASE_TEXT_H_

#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "halfspace/targets.h"

namespace halfspace::bench {

// With that many digits after the point; "-" for nothing.
std::string Fixed(double value, int digits);
std::string Fixed(const std::optional<double>& value, int digits);

// 65536 as "65 536".
std::string Grouped(std::size_t value);

// What a file name or a variable holds, safe for a terminal: control characters
// as \xNN.
std::string Printable(std::string_view text);

// "AVX-512", "AVX2", "SSE4.2" or "scalar"; otherwise Highway's name.
std::string NameOf(Target target);

// The decimal number that all of `text` is, infinite if it is too large. Not by
// std::from_chars(), which libc++ has for whole numbers alone. The program
// never leaves the "C" locale.
template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  const std::string copy(text);
  // strtod() also reads these.
  if (text.empty() || text.front() == '+' ||
      std::isspace(static_cast<unsigned char>(text.front())) != 0 ||
      text.find_first_of("xX") != std::string_view::npos) {
    return std::nullopt;
  }
  char* stop = nullptr;
  Number value;
  if constexpr (std::is_same_v<Number, float>) {
    value = std::strtof(copy.c_str(), &stop);
  } else {
    value = std::strtod(copy.c_str(), &stop);
  }
  if (stop != copy.c_str() + copy.size()) return std::nullopt;
  return value;
}

// "12 MiB", rounded up.
std::string Mebibytes(std::uintmax_t bytes);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_TEXT_H_
