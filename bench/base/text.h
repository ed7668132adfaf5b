// Numbers and names as text.
#ifndef HALFSPACE_BENCH_BASE_TEXT_H_
#define HALFSPACE_BENCH_BASE_TEXT_H_

#include <optional>
#include <string>
#include <string_view>

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

// "12 MiB", rounded up.
std::string Mebibytes(std::size_t bytes);

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_TEXT_H_
