// The message of a violated precondition: which argument, what was expected,
// what was given.
#ifndef HALFSPACE_DISPATCH_ERRORS_ERROR_H_
#define HALFSPACE_DISPATCH_ERRORS_ERROR_H_

#include <cstddef>
#include <string_view>

#include "halfspace/error.h"

namespace halfspace::dispatch {

// Throws an Error, or passes it to the program's handler.
[[noreturn, gnu::cold]] void ThrowInvalid(std::string_view call,
                                          std::string_view argument,
                                          std::string_view expected,
                                          std::string_view given,
                                          std::size_t index = Error::kNoIndex);

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_ERRORS_ERROR_H_
