#include "dispatch/errors/error.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "dispatch/exact/default_fp_mode.h"
#include "halfspace/error.h"

namespace halfspace {
namespace {

constinit std::atomic<ErrorHandler> error_handler{nullptr};

std::string Name(std::string_view argument, std::size_t index) {
  std::string name(argument);
  if (index == Error::kNoIndex) return name;
  return name + "[" + std::to_string(index) + "]";
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

bool dispatch::HasErrorHandler() { return error_handler.load() != nullptr; }

void dispatch::ThrowInvalid(std::string_view call, std::string_view argument,
                            std::string_view expected, std::string_view given,
                            std::size_t index) {
  const Error error(call, argument, expected, given, index);
  if (const ErrorHandler handler = error_handler.load(); handler != nullptr) {
    DefaultFpMode::Leave();
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
