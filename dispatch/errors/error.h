// The message of a violated precondition: which argument, what was expected,
// what was given.
#ifndef HALFSPACE_DISPATCH_ERRORS_ERROR_H_
#define HALFSPACE_DISPATCH_ERRORS_ERROR_H_

#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

#include "halfspace/error.h"

namespace halfspace::dispatch {

// Throws an Error, or passes it to the program's handler, which may leave
// without a destructor being called.
[[noreturn, gnu::cold]] void ThrowInvalid(std::string_view call,
                                          std::string_view argument,
                                          std::string_view expected,
                                          std::string_view given,
                                          std::size_t index = Error::kNoIndex);

// Whether an error is passed to a handler.
bool HasErrorHandler();

// Enough digits to tell any two numbers apart.
template <typename Scalar>
std::string Shortest(Scalar value) {
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return std::string(text.data(), end);
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ERRORS_ERROR_H_
