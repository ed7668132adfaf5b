// Numbers as text, so that nothing of them is lost.
#ifndef HALFSPACE_TESTS_FUZZ_PRINT_H_
#define HALFSPACE_TESTS_FUZZ_PRINT_H_

#include <ios>
#include <sstream>
#include <string>

namespace halfspace::testing {

template <typename Numbers>
std::string Print(const Numbers& numbers) {
  std::ostringstream text;
  text << std::hexfloat << '{';
  const char* separator = "";
  for (auto number : numbers) {
    text << separator << number;
    separator = ", ";
  }
  text << '}';
  return text.str();
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_PRINT_H_
