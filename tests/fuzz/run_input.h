// What every fuzzer does with an input that it has decoded.
//
// An input is a class that is made from Bytes, can be printed, and has
//   ::testing::AssertionResult Check() const;
#ifndef HALFSPACE_TESTS_FUZZ_RUN_INPUT_H_
#define HALFSPACE_TESTS_FUZZ_RUN_INPUT_H_

#include <gtest/gtest.h>

#include <cstdlib>
#include <ios>
#include <iostream>
#include <sstream>
#include <string>

#include "tests/fuzz/bytes.h"

namespace halfspace::testing {

// Decodes one input and checks it; each fuzzer defines its own.
void RunInput(Bytes& bytes);

// Numbers as text, so that nothing of them is lost.
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

// Ends the process, which makes the fuzzer keep the bytes, if the check fails.
// HALFSPACE_FUZZ_PRINT in the environment prints every input before its check,
// for inputs that end in a sanitizer.
template <typename Input>
void Run(Bytes& bytes) {
  static const bool print = std::getenv("HALFSPACE_FUZZ_PRINT") != nullptr;
  const Input input(bytes);
  if (print) std::cerr << input << std::endl;
  const ::testing::AssertionResult result = input.Check();
  if (result && !::testing::Test::HasFailure()) return;
  std::cerr << "WRONG: " << result.message() << "\nThe input:\n"
            << input << std::endl;
  std::abort();
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_RUN_INPUT_H_
