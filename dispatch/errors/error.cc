#include "dispatch/errors/error.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

#include "dispatch/default_fp_mode.h"
#include "halfspace/error.h"

namespace halfspace {
namespace {

constinit std::atomic<ErrorHandler> error_handler{nullptr};

std::string Name(std::string_view argument, std::size_t index) {
  std::string name(argument);
  if (index == Error::kNoIndex) return name;
  return name + "[" + std::to_string(index) + "]";
}

// Not by std::to_chars(), which macOS has since its version 13.3.
template <typename Scalar>
std::string TextOf(Scalar value) {
  using Limits = std::numeric_limits<Scalar>;
  if (std::isnan(value)) return "nan";
  std::array<char, 32> printed;
  const int its_errno = errno;
  // Conversions compute, so the caller's mode could round them or trap them.
  dispatch::InDefaultFpMode([&] {
    for (int digits = Limits::digits10; digits <= Limits::max_digits10;
         ++digits) {
      std::snprintf(printed.data(), printed.size(), "%.*g", digits,
                    double{value});
      // The 9 digits of a float are another double.
      const double read = std::strtod(printed.data(), nullptr);
      if (std::abs(read) <= Limits::max() &&
          static_cast<Scalar>(read) == value) {
        break;
      }
    }
  });
  errno = its_errno;
  // The point can be another character, of several bytes.
  std::string text;
  for (const char* c = printed.data(); *c != '\0'; ++c) {
    if (std::strchr("+-0123456789einfa", *c) != nullptr) {
      text += *c;
    } else if (text.back() != '.') {
      text += '.';
    }
  }
  return text;
}

}  // namespace

Error::Error(std::string_view call, std::string_view argument,
             std::string_view expected, std::string_view given,
             std::size_t index)
    : std::invalid_argument("halfspace: " + std::string(call) + ": " +
                            Name(argument, index) + ": expected " +
                            std::string(expected) + ", got " +
                            std::string(given)),
      call_(call.size()),
      argument_(argument.size()),
      name_(Name(argument, index).size()),
      expected_(expected.size()),
      index_(index) {}

ErrorHandler SetErrorHandler(ErrorHandler handler) noexcept {
  return error_handler.exchange(handler);
}

std::string detail::NumberText(float value) { return TextOf(value); }
std::string detail::NumberText(double value) { return TextOf(value); }

void dispatch::ThrowInvalid(std::string_view call, std::string_view argument,
                            std::string_view expected, std::string_view given,
                            std::size_t index) {
  const Error error(call, argument, expected, given, index);
  if (const ErrorHandler handler = error_handler.load(); handler != nullptr) {
    handler(error);
    std::abort();
  }
#if defined(__cpp_exceptions)
  throw error;
#else
  std::fprintf(stderr, "%s\n", error.what());
  std::abort();
#endif
}

}  // namespace halfspace
