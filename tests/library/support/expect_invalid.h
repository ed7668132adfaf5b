// Checks that a call refuses, and says why; and pointers that no call may take.
#ifndef HALFSPACE_TESTS_LIBRARY_SUPPORT_EXPECT_INVALID_H_
#define HALFSPACE_TESTS_LIBRARY_SUPPORT_EXPECT_INVALID_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>

#include "halfspace/error.h"

namespace halfspace::testing {

// `pointer`, one byte further.
template <typename T>
T* Misaligned(T* pointer) {
  return reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(pointer) + 1);
}

// What a handler of errors is told by call(), or nothing.
inline std::string ToldBy(const std::function<void()>& call) {
  struct Told {
    std::string message;
  };
  const ErrorHandler before =
      SetErrorHandler([](const Error& error) { throw Told{error.what()}; });
  std::string message;
  try {
    call();
  } catch (const Told& told) {
    message = told.message;
  }
  SetErrorHandler(before);
  return message;
}

// call() throws an Error with all of `parts` in its text, in that
// order, and tells a handler the same text.
inline ::testing::AssertionResult Refuses(
    const std::function<void()>& call,
    std::initializer_list<std::string_view> parts) {
  try {
    call();
  } catch (const Error& error) {
    const std::string_view text = error.what();
    std::size_t from = 0;
    for (std::string_view part : parts) {
      const std::size_t at = text.find(part, from);
      if (at == std::string_view::npos) {
        return ::testing::AssertionFailure()
               << "no \"" << part << "\" in its place in \"" << text << '"';
      }
      from = at + part.size();
    }
    if (const std::string told = ToldBy(call); told != text) {
      return ::testing::AssertionFailure()
             << "a handler is told \"" << told << "\", not \"" << text << '"';
    }
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

// EXPECT_REFUSED((call), part, ...): an expression in parentheses.
inline void ExpectRefused(const char* file, int line, const char* text,
                          const std::function<void()>& call,
                          std::initializer_list<std::string_view> parts) {
  const ::testing::AssertionResult result = Refuses(call, parts);
  if (!result) {
    ADD_FAILURE_AT(file, line) << text << ": " << result.message();
  }
}
#define EXPECT_REFUSED(call, ...)                                \
  ::halfspace::testing::ExpectRefused(__FILE__, __LINE__, #call, \
                                      [&] { (void)(call); }, {__VA_ARGS__})

}  // namespace halfspace::testing

#endif  // HALFSPACE_TESTS_LIBRARY_SUPPORT_EXPECT_INVALID_H_
