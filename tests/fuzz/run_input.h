// What every fuzzer does with an input that it has decoded.
//
// An input is a class that is made from Bytes, can be printed, and has
//   ::testing::AssertionResult Check() const;
#ifndef HALFSPACE_TESTS_FUZZ_RUN_INPUT_H_
#define HALFSPACE_TESTS_FUZZ_RUN_INPUT_H_

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "tests/fuzz/bytes.h"

namespace halfspace::testing {

// Decodes one input and checks it; each fuzzer defines its own.
void RunInput(Bytes& bytes);

// Ends the process, which makes the fuzzer keep the bytes, if the check fails.
// HALFSPACE_FUZZ_PRINT in the environment prints every input before its check,
// for inputs that end in a sanitizer.
template <typename Input>
void Run(Bytes& bytes) {
  static const bool print = std::getenv("HALFSPACE_FUZZ_PRINT") != nullptr;
  const Input input(bytes);
  if (print) std::cerr << input << std::endl;
  const ::testing::AssertionResult result = input.Check();
  if (result) return;
  std::cerr << "WRONG: " << result.message() << "\nThe input:\n"
            << input << std::endl;
  std::abort();
}

// Whether the library has kernels of so many dimensions. If not, an input of
// them is not run: the inputs that are kept mean the same in every build.
constexpr bool IsInLibrary(int dims) {
#if defined(HALFSPACE_FUZZ_WITHOUT_4D)
  return dims < 4;
#else
  return dims <= 4;
#endif
}

template <typename>
constexpr bool kIsTested = true;
template <template <typename> class Input, typename View>
requires requires { View::Bound::kDimensions; }
constexpr bool kIsTested<Input<View>> = IsInLibrary(View::Bound::kDimensions);
template <template <typename> class Input, typename Case>
requires requires { Case::View::Bound::kDimensions; }
constexpr bool kIsTested<Input<Case>> =
    IsInLibrary(Case::View::Bound::kDimensions);

template <typename Input>
void RunIfTested(Bytes& bytes) {
  if constexpr (kIsTested<Input>) Run<Input>(bytes);
}

// Runs the one of the input types that a byte chooses.
template <typename... Inputs>
void RunOneOf(::testing::Types<Inputs...>, Bytes& bytes) {
  using Runner = void (*)(Bytes&);
  constexpr Runner kRunners[] = {&RunIfTested<Inputs>...};
  kRunners[bytes.Below(sizeof...(Inputs))](bytes);
}

// The same for one of the lists Inputs<2>, Inputs<3> and Inputs<4>.
template <template <int> class Inputs>
void RunOneOfAllDims(Bytes& bytes) {
  switch (bytes.Below(3)) {
    case 0:
      return RunOneOf(Inputs<2>(), bytes);
    case 1:
      return RunOneOf(Inputs<3>(), bytes);
    default:
      if constexpr (IsInLibrary(4)) RunOneOf(Inputs<4>(), bytes);
  }
}

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_FUZZ_RUN_INPUT_H_
