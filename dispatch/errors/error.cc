#include "dispatch/errors/error.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "dispatch/exact/default_fp_mode.h"
#include "halfspace/error.h"

namespace halfspace {
namespace {

constinit std::atomic<ErrorHandler> error_handler{nullptr};

}  // namespace

ErrorHandler SetErrorHandler(ErrorHandler handler) noexcept {
  return error_handler.exchange(handler);
}

void dispatch::ThrowInvalid(std::string_view call, std::string_view argument,
                            std::string_view expected, std::string_view given) {
  std::string text = "halfspace: ";
  text.append(call).append(": ").append(argument);
  text.append(": expected ").append(expected);
  text.append(", got ").append(given);
  if (const ErrorHandler handler = error_handler.load(); handler != nullptr) {
    DefaultFpMode::Leave();
    handler(text.c_str());
    std::abort();
  }
#if defined(__cpp_exceptions)
  throw std::invalid_argument(text);
#else
  std::fprintf(stderr, "%s\n", text.c_str());
  std::abort();
#endif
}

}  // namespace halfspace
